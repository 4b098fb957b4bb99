// SPDX-License-Identifier: MIT
#include "earshot/cli/manual_page.h"

#include <cctype>
#include <sstream>
#include <string_view>
#include <vector>

namespace earshot::cli {
namespace {

std::string upper_case(std::string text) {
    for (char& letter : text) {
        letter = static_cast<char>(std::toupper(static_cast<unsigned char>(letter)));
    }
    return text;
}

// Text as roff takes it: what is copied from a page must be what was meant, so that a hyphen is the
// one of an option, and no line may look like a request.
std::string escaped(std::string_view text) {
    std::string result;
    bool at_line_start = true;
    for (const char letter : text) {
        if (at_line_start && (letter == '.' || letter == '\'')) {
            result += "\\&";
        }
        if (letter == '\\') {
            result += "\\e";
        } else if (letter == '-') {
            result += "\\-";
        } else if (letter == '\'') {
            result += "\\(aq";
        } else if (letter == '^') {
            result += "\\(ha";
        } else if (letter == '~') {
            result += "\\(ti";
        } else {
            result += letter;
        }
        at_line_start = letter == '\n';
    }
    return result;
}

std::string bold(const std::string& text) {
    return "\\fB" + escaped(text) + "\\fR";
}

std::string italic(const std::string& text) {
    return "\\fI" + escaped(text) + "\\fR";
}

std::string section(const std::string& title) {
    return ".SH " + upper_case(title) + "\n";
}

std::vector<std::string> paragraphs_of(const std::string& text) {
    std::vector<std::string> paragraphs;
    std::istringstream lines(text);
    bool is_new = true;
    for (std::string line; std::getline(lines, line);) {
        if (line.empty()) {
            is_new = true;
        } else if (is_new) {
            paragraphs.push_back(line + "\n");
            is_new = false;
        } else {
            paragraphs.back() += line + "\n";
        }
    }
    return paragraphs;
}

// A paragraph with indented lines is a table or an example: its lines stay as they are.
std::string paragraph(const std::string& text) {
    const bool is_laid_out = text.starts_with(' ') || text.find("\n ") != std::string::npos;
    return is_laid_out ? ".PP\n.nf\n" + escaped(text) + ".fi\n" : ".PP\n" + escaped(text);
}

// What stands below the options in the help: what the command does, examples, notes.
struct FooterSections {
    std::string description, examples, notes;
};

FooterSections footer_sections(const std::string& footer) {
    constexpr std::string_view kExamples = "Examples:\n";
    FooterSections sections;
    for (const std::string& text : paragraphs_of(footer)) {
        if (text.starts_with(kExamples)) {
            sections.examples += section("Examples") + paragraph(text.substr(kExamples.size()));
        } else if (sections.examples.empty()) {
            sections.description += sections.description.empty() ? section("Description") : "";
            sections.description += paragraph(text);
        } else {
            sections.notes += sections.notes.empty() ? section("Notes") : "";
            sections.notes += paragraph(text);
        }
    }
    return sections;
}

// What the help shows beside the placeholder: " (required; may be repeated; default: 4)".
std::string facts(const OptionEntry& option) {
    std::string text = option.is_required ? "required" : "";
    if (option.is_repeatable) {
        text += std::string(text.empty() ? "" : "; ") + "may be repeated";
    }
    if (!option.default_value.empty()) {
        text += (text.empty() ? "default: " : "; default: ") + option.default_value;
    }
    return text.empty() ? "" : " (" + text + ")";
}

// "-o, --output=FILE" with its description.
std::string option_item(const OptionEntry& option) {
    std::string names;
    for (const std::string& name : option.names) {
        names += (names.empty() ? "" : ", ") + bold(name);
    }
    const std::string value =
        option.value == ValueKind::choice ? joined(option.choices, "|") : option.placeholder;
    return ".TP\n" + names + (value.empty() ? "" : " " + italic(value)) + "\n" +
           escaped(option.description + facts(option)) + "\n";
}

std::string synopsis(const CommandEntry& command) {
    std::string text = section("Synopsis") + bold(joined(command.words, " "));
    for (const OptionEntry& option : command.options) {
        if (option.is_required) {
            text += " " + bold(option.names.back()) + " " + italic(option.placeholder);
        }
    }
    text += " [" + italic("OPTION") + " ...]";
    for (const OptionEntry& argument : command.arguments) {
        const std::string name =
            italic(argument.names.front()) + (argument.is_repeatable ? " ..." : "");
        text += argument.is_required ? " " + name : " [" + name + "]";
    }
    return text + (command.commands.empty() ? "" : " " + italic("COMMAND")) + "\n";
}

std::string page_name(const CommandEntry& command) {
    return bold(joined(command.words, "-")) + "(1)";
}

std::string options_section(const CommandEntry& command) {
    std::string text;
    if (!command.arguments.empty()) {
        text += section("Arguments");
        for (const OptionEntry& argument : command.arguments) {
            text += ".TP\n" + italic(argument.names.front()) + "\n" +
                    escaped(argument.description) + "\n";
        }
    }
    std::string group;
    for (const OptionEntry& option : command.options) {
        if (option.group != group) {
            group = option.group;
            text += section(group);
        }
        text += option_item(option);
    }
    if (!command.commands.empty()) {
        text += section("Commands");
        for (const CommandEntry& below : command.commands) {
            text += ".TP\n" + page_name(below) + "\n" + escaped(below.description) + "\n";
        }
    }
    return text;
}

std::string see_also(const CommandEntry& program, const CommandEntry& command) {
    std::string text;
    for (const CommandEntry* other : all_commands(program)) {
        if (other->words != command.words) {
            text += (text.empty() ? "" : ",\n") + page_name(*other);
        }
    }
    return section("See also") + text + "\n";
}

}  // namespace

std::string manual_page(const CommandEntry& program,
                        const CommandEntry& command,
                        const std::string& version) {
    const std::string name = joined(command.words, "-");
    const FooterSections footer = footer_sections(command.footer);
    return ".TH " + escaped(upper_case(name)) + " 1 \"\" \"earshot " + escaped(version) +
           "\" \"earshot manual\"\n" + section("Name") + escaped(name) + " \\- " +
           escaped(command.description) + "\n" + synopsis(command) + footer.description +
           options_section(command) + footer.examples + footer.notes + section("Exit status") +
           "0 on success, 1 if an input or the computation failed, 2 if the command line is " +
           (command.footer.find("Exit status 3") == std::string::npos
                ? "wrong.\n"
                : "wrong, 3 as described above.\n") +
           section("Environment") + ".TP\n" + bold("NO_COLOR") +
           "\nIf it is set and not empty, messages on a terminal have no colour.\n" +
           see_also(program, command);
}

}  // namespace earshot::cli
