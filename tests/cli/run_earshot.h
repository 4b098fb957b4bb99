// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include "support/earshot_program.h"
#include "support/run_program.h"
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace earshot::test {

/// Runs the earshot program.
inline RunResult run_earshot(std::vector<std::string> arguments, const RunOptions& options = {}) {
    arguments.insert(arguments.begin(), earshot_program());
    return run_program(arguments, options);
}

/// Passes if `result` ended with `status`, nothing on standard output and one error line that
/// holds `part`.
inline testing::AssertionResult failed_with(const RunResult& result,
                                            int status,
                                            const std::string& part) {
    const bool is_one_line = result.err.starts_with("earshot: error: ") &&
                             std::count(result.err.begin(), result.err.end(), '\n') == 1 &&
                             result.err.ends_with('\n');
    if (result.status == status && result.out.empty() && is_one_line &&
        result.err.find(part) != std::string::npos) {
        return testing::AssertionSuccess();
    }
    return testing::AssertionFailure()
           << "expected exit status " << status << ", no output and one error line with \"" << part
           << "\"; got status " << result.status << ", output \"" << result.out
           << "\", standard error \"" << result.err << "\"";
}

}  // namespace earshot::test
