// SPDX-License-Identifier: MIT
#include "earshot/base/error.h"

#include <utility>

namespace earshot {

Error::Error(std::string subject, const std::string& what, std::string remedy)
    : std::runtime_error(what), subject_(std::move(subject)), remedy_(std::move(remedy)) {}

std::string Error::line() const {
    std::string text = subject_.empty() ? std::string(what()) : subject_ + ": " + what();
    if (!remedy_.empty()) {
        text += "; " + remedy_;
    }
    return text;
}

}  // namespace earshot
