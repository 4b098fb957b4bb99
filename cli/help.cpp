// SPDX-License-Identifier: MIT
#include "earshot/cli/commands.h"
#include "earshot/cli/completion.h"
#include "earshot/cli/manual_page.h"
#include "earshot/cli/output.h"
#include "earshot/io/whole_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace earshot::cli {
namespace {

class HelpCommand : public Command {
public:
    explicit HelpCommand(CLI::App& program)
        : Command(program, "help", "Describe a command, as its --help does", WithoutOptions{}),
          program_(program) {
        app()
            .add_option("COMMAND", words_, "the command; earshot's own help if it is left out")
            ->type_name("");
        app().footer(
            "Examples:\n"
            "  earshot help ir\n"
            "  earshot help pvs build");
    }

    void run() override {
        const CLI::App* command = &program_;
        for (const std::string& word : words_) {
            command = &find_command(*command, word);
        }
        // Not help(), which goes on to the command that was parsed, this one.
        write_output(command->get_formatter()->make_help(
            command, full_name(*command), CLI::AppFormatMode::Normal));
    }

private:
    CLI::App& program_;
    std::vector<std::string> words_;
};

// Not listed: the build runs it, and packages install what it writes.
class ManualsCommand : public Command {
public:
    explicit ManualsCommand(CLI::App& program)
        : Command(program,
                  "generate-manuals",
                  "Write manual pages and completions into a folder",
                  WithoutOptions{}),
          program_(program) {
        app().group("");
        app().add_option("FOLDER", folder_, "gets what belongs into share/")->required();
    }

    void run() override {
        const CommandEntry program = command_tree(program_);
        for (const CommandEntry* command : all_commands(program)) {
            write("man/man1/" + joined(command->words, "-") + ".1",
                  manual_page(program, *command, EARSHOT_VERSION));
        }
        write("bash-completion/completions/earshot", bash_completion(program));
        write("zsh/site-functions/_earshot", zsh_completion(program));
        write("fish/vendor_completions.d/earshot.fish", fish_completion(program));
    }

private:
    void write(const std::string& name, const std::string& text) const {
        const std::filesystem::path file = std::filesystem::path(folder_) / name;
        std::error_code failure;  // told by the write
        std::filesystem::create_directories(file.parent_path(), failure);
        io::write_whole_file(file, text);
    }

    const CLI::App& program_;
    std::string folder_;
};

}  // namespace

std::unique_ptr<Command> make_help_command(CLI::App& program) {
    return std::make_unique<HelpCommand>(program);
}

std::unique_ptr<Command> make_manuals_command(CLI::App& program) {
    return std::make_unique<ManualsCommand>(program);
}

}  // namespace earshot::cli
