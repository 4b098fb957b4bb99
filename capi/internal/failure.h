// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/earshot.h"

#include <exception>
#include <string>

namespace earshot::capi {

/// A call was given what it cannot work with. Its subject is the argument's name; the name of the
/// function is put before it where the failure is recorded.
class Failure : public std::exception {
public:
    Failure(es_status status, std::string argument, std::string problem, std::string remedy);

    es_status status() const noexcept { return status_; }
    const std::string& argument() const noexcept { return argument_; }
    const std::string& problem() const noexcept { return problem_; }
    const std::string& remedy() const noexcept { return remedy_; }
    const char* what() const noexcept override { return problem_.c_str(); }

private:
    es_status status_;
    std::string argument_, problem_, remedy_;
};

/// A callback asked to stop.
class Cancelled : public std::exception {
public:
    const char* what() const noexcept override { return "cancelled"; }
};

/// To be called in a handler: remembers the exception for this thread and returns its status.
es_status record_exception(const char* function) noexcept;

/// The body of an exported function: nothing is thrown beyond it.
template <typename Body>
es_status call(const char* function, Body&& body) noexcept {
    try {
        body();
        return ES_OK;
    } catch (...) {
        return record_exception(function);
    }
}

}  // namespace earshot::capi
