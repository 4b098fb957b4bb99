// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/failure.h"

#include "earshot/base/error.h"

#include <array>
#include <new>
#include <stdexcept>
#include <utility>

namespace earshot::capi {
namespace {

/// The last failure of a thread.
struct LastFailure {
    es_status status = ES_OK;
    std::string subject, problem, remedy, message;
};

LastFailure& last_failure() noexcept {
    thread_local LastFailure failure;
    return failure;
}

void record(es_status status, std::string subject, std::string problem, std::string remedy) {
    LastFailure& last = last_failure();
    last.message = Error(subject, problem, remedy).line();
    last.status = status;
    last.subject = std::move(subject);
    last.problem = std::move(problem);
    last.remedy = std::move(remedy);
}

/// Remembers the exception that is being handled; what it throws itself is for want of memory.
es_status record_current(const std::string& function) {
    try {
        throw;
    } catch (const Failure& failure) {
        record(failure.status(),
               failure.argument().empty() ? function : function + ", " + failure.argument(),
               failure.problem(),
               failure.remedy());
    } catch (const Cancelled&) {
        record(ES_ERROR_CANCELLED, function, "was cancelled by its progress callback", "");
    } catch (const Error& error) {
        record(ES_ERROR_FAILED,
               error.subject().empty() ? function : error.subject(),
               error.what(),
               error.remedy());
    } catch (const std::bad_alloc&) {
        record(ES_ERROR_OUT_OF_MEMORY, function, "memory is exhausted", "ask for less at a time");
    } catch (const std::length_error&) {
        record(ES_ERROR_OUT_OF_MEMORY, function, "memory is exhausted", "ask for less at a time");
    } catch (const std::exception& error) {
        record(ES_ERROR_INTERNAL,
               function,
               std::string("failed unexpectedly: ") + error.what(),
               "report this as a fault of earshot");
    } catch (...) {
        record(ES_ERROR_INTERNAL,
               function,
               "failed unexpectedly",
               "report this as a fault of earshot");
    }
    return last_failure().status;
}

}  // namespace

Failure::Failure(es_status status, std::string argument, std::string problem, std::string remedy)
    : status_(status),
      argument_(std::move(argument)),
      problem_(std::move(problem)),
      remedy_(std::move(remedy)) {}

es_status record_exception(const char* function) noexcept {
    try {
        return record_current(function);
    } catch (...) {
        // Not even the text of the failure finds room.
        LastFailure& last = last_failure();
        last.status = ES_ERROR_OUT_OF_MEMORY;
        last.subject.clear();
        last.problem.clear();
        last.remedy.clear();
        last.message.clear();
        return ES_ERROR_OUT_OF_MEMORY;
    }
}

}  // namespace earshot::capi

using earshot::capi::last_failure;

const char* es_status_name(int32_t status) {
    constexpr std::array<const char*, 10> kNames = {"ES_OK",
                                                    "ES_ERROR_HANDLE",
                                                    "ES_ERROR_NULL",
                                                    "ES_ERROR_ARGUMENT",
                                                    "ES_ERROR_INDEX",
                                                    "ES_ERROR_FAILED",
                                                    "ES_ERROR_CANCELLED",
                                                    "ES_ERROR_BUSY",
                                                    "ES_ERROR_OUT_OF_MEMORY",
                                                    "ES_ERROR_INTERNAL"};
    const bool is_known = status >= 0 && static_cast<std::size_t>(status) < kNames.size();
    return is_known ? kNames[static_cast<std::size_t>(status)] : "unknown";
}

const char* es_error_subject(void) {
    return last_failure().subject.c_str();
}

const char* es_error_problem(void) {
    return last_failure().problem.c_str();
}

const char* es_error_remedy(void) {
    return last_failure().remedy.c_str();
}

const char* es_error_message(void) {
    return last_failure().message.c_str();
}

es_status es_error_status(void) {
    return last_failure().status;
}
