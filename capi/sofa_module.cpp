// SPDX-License-Identifier: MIT
// libearshot-sofa.so.
#include "earshot/capi/internal/sofa_module.h"

#include "earshot/base/error.h"
#include "earshot/capi/earshot.h"
#include "earshot/io/sofa.h"

#include <exception>

namespace earshot::capi {

extern "C" __attribute__((visibility("default"))) std::uint32_t earshot_sofa_version() {
    return ES_VERSION;
}

extern "C" __attribute__((visibility("default"))) void earshot_sofa_read(const char* file,
                                                                         SofaReading* reading) {
    try {
        reading->set = io::read_hrir_set(file);
    } catch (const Error& error) {
        *reading = {.has_failed = true,
                    .subject = error.subject(),
                    .problem = error.what(),
                    .remedy = error.remedy()};
    } catch (const std::exception& error) {
        *reading = {.has_failed = true, .subject = file, .problem = error.what()};
    }
}

}  // namespace earshot::capi
