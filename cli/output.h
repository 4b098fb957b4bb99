// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"

#include <string>
#include <string_view>

namespace earshot::cli {

/// To be called first: makes a closed standard stream fail when it is used, instead of letting its
/// number go to the next file that is opened, and turns a vanished reader into a failed write.
void prepare_standard_streams();

/// Writes all of `output` to standard output, control characters but line feeds as escapes. A
/// reader that has gone away (`earshot ... | head`) has what it wanted: that is no failure. Throws
/// Error if the text cannot be written otherwise.
void write_output(std::string_view output);

/// Prints `earshot: error: MESSAGE` to standard error; like warnings, with colour on a terminal
/// unless the environment has NO_COLOR.
void print_error(const std::string& message);

/// Prints one line `earshot: warning: SUBJECT: WHAT` for each to standard error.
void print_warnings(const Warnings& warnings);

/// The text on one line: control characters, which names may hold, become escapes.
std::string on_one_line(std::string_view text);

}  // namespace earshot::cli
