// SPDX-License-Identifier: MIT
#include "run_earshot.h"

namespace earshot::test {
namespace {

TEST(Program, HelpListsTheCommandsAndExitStatus) {
    const RunResult result = run_earshot({"--help"});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.err, "");
    for (const char* part :
         {"Usage: earshot", "materials", "Exit status: 0 success, 1", "--version"}) {
        EXPECT_NE(result.out.find(part), std::string::npos) << part << " in\n" << result.out;
    }
}

/// Every command that the help of `words` lists, and those that theirs list; returns how many.
int expect_help_of_commands(const std::vector<std::string>& words) {
    const auto help_of = [](std::vector<std::string> command) {
        command.emplace_back("--help");
        return run_earshot(command);
    };
    const std::string help = help_of(words).out;
    const std::size_t list = help.find("\nCommands:\n");
    if (list == std::string::npos) {
        EXPECT_NE(help.find("-h,--help"), std::string::npos) << help;
        return 0;
    }
    int commands = 0;
    std::size_t line = help.find('\n', list + 1) + 1;
    while (help.compare(line, 2, "  ") == 0) {
        const std::size_t begin = line + 2;
        std::vector<std::string> command = words;
        command.push_back(help.substr(begin, help.find(' ', begin) - begin));
        std::string example = "  earshot";
        for (const std::string& word : command) {
            example += " " + word;
        }
        const RunResult result = help_of(command);
        EXPECT_EQ(result.status, 0) << example;
        EXPECT_NE(result.out.find(example), std::string::npos) << result.out;
        commands += 1 + expect_help_of_commands(command);
        line = help.find('\n', line) + 1;
    }
    return commands;
}

TEST(Program, EveryCommandListedHasHelpThatShowsAnExample) {
    EXPECT_GE(expect_help_of_commands({}), 12);
}

TEST(Program, PrintsItsVersion) {
    const RunResult result = run_earshot({"--version"});
    EXPECT_EQ(result.status, 0);
    EXPECT_EQ(result.out, "earshot " EARSHOT_VERSION "\n");
    EXPECT_EQ(run_earshot({"-V"}).out, result.out);
}

TEST(Program, ShowsCommonOptionsWhereTheyAct) {
    struct Case {
        std::vector<std::string> command;
        bool threads, seed, simd;
    };
    const std::vector<Case> cases = {{{"ir"}, true, true, true},
                                     {{"metrics"}, false, false, false},
                                     {{"auralize"}, true, true, true},
                                     {{"bvh"}, true, false, true},
                                     {{"los"}, true, false, true},
                                     {{"visible"}, true, false, true},
                                     {{"pvs", "build"}, true, true, true},
                                     {{"pvs", "query"}, false, false, false},
                                     {{"pvs", "show"}, false, false, false},
                                     {{"pvs", "extract"}, false, false, false},
                                     {{"collide"}, true, false, true},
                                     {{"ccd"}, true, false, false},
                                     {{"materials"}, false, false, false}};
    for (const auto& [command, threads, seed, simd] : cases) {
        std::vector<std::string> arguments = command;
        arguments.emplace_back("--help");
        const std::string help = run_earshot(arguments).out;
        const auto shows = [&](const char* option) {
            return help.find("\n  " + std::string(option)) != std::string::npos;
        };
        EXPECT_EQ(shows("--threads"), threads) << help;
        EXPECT_EQ(shows("--seed"), seed) << help;
        EXPECT_EQ(shows("--simd"), simd) << help;
        EXPECT_TRUE(shows("--quiet") && shows("--json")) << help;
    }
    // Scripts pass them to every command all the same.
    EXPECT_EQ(run_earshot({"materials", "--threads", "1", "--seed", "2", "--simd", "auto"}).status,
              0);
}

TEST(Program, HelpCommandPrintsWhatTheOptionPrints) {
    const std::vector<std::vector<std::string>> commands = {
        {}, {"ir"}, {"pvs"}, {"pvs", "build"}, {"help"}};
    for (const std::vector<std::string>& command : commands) {
        std::vector<std::string> by_command = command;
        by_command.insert(by_command.begin(), "help");
        std::vector<std::string> by_option = command;
        by_option.emplace_back("--help");
        const RunResult result = run_earshot(by_command);
        EXPECT_EQ(result.status, 0);
        EXPECT_EQ(result.out, run_earshot(by_option).out);
    }
    EXPECT_TRUE(failed_with(run_earshot({"help", "materals"}), 2, "did you mean materials?"));
    EXPECT_TRUE(failed_with(run_earshot({"help", "pvs", "biuld"}), 2, "did you mean build?"));
    EXPECT_TRUE(failed_with(run_earshot({"help", "ir", "x"}), 2, "x: no such command"));
}

TEST(Program, RefusesToGuessACommand) {
    EXPECT_TRUE(failed_with(run_earshot({}), 2, "no command is given; see earshot --help"));
    EXPECT_TRUE(failed_with(run_earshot({"materails"}), 2, "did you mean materials?"));
    EXPECT_TRUE(failed_with(run_earshot({"xyzzy"}), 2, "xyzzy: no such command; see"));
    EXPECT_TRUE(failed_with(run_earshot({""}), 2, "no such command"));
}

TEST(Program, SuggestsTheOptionThatWasMeant) {
    EXPECT_TRUE(failed_with(run_earshot({"materials", "--theads", "2"}),
                            2,
                            "--theads: earshot materials has no such "
                            "option; did you mean --threads?"));
    EXPECT_TRUE(failed_with(run_earshot({"materials", "--jsno"}), 2, "did you mean --json?"));
    EXPECT_TRUE(failed_with(run_earshot({"materials", "-x"}), 2, "no such option; see"));
    EXPECT_TRUE(
        failed_with(run_earshot({"--threads", "2", "materials"}), 2, "put it after: earshot"));
}

TEST(Program, RefusesValuesThatAreNotWhatTheOptionTakes) {
    for (const char* value :
         {"-1", "1025", "1.5", "2x", "", "0x2", "99999999999999999999", "nan"}) {
        EXPECT_TRUE(failed_with(run_earshot({"materials", "--threads", value}),
                                2,
                                "is not a whole number from 0 to 1024"));
    }
    EXPECT_TRUE(failed_with(
        run_earshot({"materials", "--seed", "-1"}), 2, "is not a whole number of at least 0"));
    EXPECT_TRUE(failed_with(run_earshot({"materials", "--seed"}), 2, "--seed: needs a value"));
    EXPECT_TRUE(failed_with(
        run_earshot({"materials", "--seed", "1", "--seed", "2"}), 2, "is given more than once"));
    EXPECT_TRUE(
        failed_with(run_earshot({"materials", "a", "b"}), 2, "b: is one argument too many"));
}

TEST(Program, PutsErrorsOnOneLineWhateverTheArgumentsHold) {
    EXPECT_TRUE(failed_with(run_earshot({"two\nlines"}), 2, R"(two\u000alines)"));
    EXPECT_TRUE(
        failed_with(run_earshot({"materials", "\x1b[31mred\r"}), 2, R"(\u001b[31mred\u000d)"));
}

TEST(Program, FailsIfItsOutputCannotBeWritten) {
    const RunResult full = run_earshot({"materials"}, {.standard_output = "/dev/full"});
    EXPECT_TRUE(failed_with(full, 1, "standard output: cannot be written"));
    const RunResult closed = run_earshot({"--help"}, {.closes_standard_output = true});
    EXPECT_TRUE(failed_with(closed, 1, "standard output: cannot be written"));
}

TEST(Program, TakesAReaderThatHasGoneAwayForContent) {
    const RunResult result = run_program({"/bin/sh",
                                          "-c",
                                          "{ sleep 0.1; \"$0\" materials; echo $? >&2; } | true",
                                          test::earshot_program()});
    EXPECT_EQ(result.err, "0\n");
}

TEST(Program, HelpShowsTheDefaultsOfNumbers) {
    const std::string help = run_earshot({"ir", "--help"}).out;
    EXPECT_NE(help.find("--sample-rate N=48000"), std::string::npos) << help;
    EXPECT_NE(help.find("--pressure X=101.325"), std::string::npos) << help;
    // None by default, and a default that the description tells.
    EXPECT_NE(help.find("--min-level X "), std::string::npos) << help;
    EXPECT_NE(help.find("--threads N "), std::string::npos) << help;
}

}  // namespace
}  // namespace earshot::test
