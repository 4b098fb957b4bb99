// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"

#include <stdexcept>
#include <string>
#include <vector>

namespace earshot {

/// The input or the work failed in a way the user can mend. The command line prints
/// `earshot: error: SUBJECT: WHAT; REMEDY`. Mistakes of the calling code are asserts, not Errors.
class Error : public std::runtime_error {
public:
    /// `what` and `remedy` are clauses without a full stop; an empty `remedy` is left out.
    Error(std::string subject, const std::string& what, std::string remedy = {});

    const std::string& subject() const noexcept { return subject_; }  ///< file, node, option, ...
    const std::string& remedy() const noexcept { return remedy_; }    ///< what would mend it

    /// The whole line without the program's name: `SUBJECT: WHAT; REMEDY`.
    std::string line() const;

private:
    std::string subject_;
    std::string remedy_;
};

/// Odd, but the work went on; returned beside the result, never printed by the library.
struct Warning {
    std::string subject;
    std::string what;
};

using Warnings = std::vector<Warning>;

}  // namespace earshot
