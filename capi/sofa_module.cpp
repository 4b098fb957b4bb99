// SPDX-License-Identifier: MIT
// libearshot-sofa.so.
#include "earshot/capi/internal/sofa_module.h"

#include "earshot/base/error.h"
#include "earshot/capi/earshot.h"
#include "earshot/io/sofa.h"

#include <exception>
#include <mutex>

namespace earshot::capi {
namespace {

/// Does what HDF5 may do on one thread at a time; reading forks, and the child must not meet a lock
/// that another thread holds.
template <typename Work>
void run(const char* subject, SofaFailure& failure, const Work& work) {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    try {
        work();
    } catch (const Error& error) {
        failure = {.has_failed = true,
                   .subject = error.subject(),
                   .problem = error.what(),
                   .remedy = error.remedy()};
    } catch (const std::exception& error) {
        failure = {.has_failed = true, .subject = subject, .problem = error.what()};
    }
}

}  // namespace

extern "C" __attribute__((visibility("default"))) std::uint32_t earshot_sofa_version() {
    return ES_VERSION;
}

extern "C" __attribute__((visibility("default"))) void earshot_sofa_read(const char* file,
                                                                         SofaReading* reading) {
    run(file, reading->failure, [&] { reading->set = io::read_hrir_set(file); });
}

extern "C" __attribute__((visibility("default"))) void earshot_sofa_write(SofaWriting* writing) {
    run("", writing->failure, [&] {
        writing->bytes =
            io::encode_room_responses(writing->title, writing->kind, writing->measurements);
    });
}

}  // namespace earshot::capi
