// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/hrir_reader.h"

#include "earshot/base/error.h"
#include "earshot/capi/earshot.h"
#include "earshot/capi/internal/sofa_module.h"
#include "earshot/io/sofa.h"

#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <string>
#include <system_error>

namespace earshot::capi {
namespace {

namespace fs = std::filesystem;

/// The module beside this library: beside the file that was loaded, or beside what that is a
/// link to.
void* open_module() {
    Dl_info library{};
    if (dladdr(reinterpret_cast<const void*>(&es_version), &library) == 0) {
        return nullptr;
    }
    const fs::path file(library.dli_fname);
    std::error_code failure;
    for (const fs::path& place : {file, fs::canonical(file, failure)}) {
        if (void* module =
                dlopen((place.parent_path() / kSofaModule).c_str(), RTLD_NOW | RTLD_LOCAL)) {
            return module;
        }
    }
    return nullptr;
}

/// A function of the module; null if the module has none of that name.
template <typename Function>
Function function_of(void* module, const char* name) {
    void* const symbol = dlsym(module, name);
    Function function = nullptr;
    static_assert(sizeof function == sizeof symbol);
    std::memcpy(&function, &symbol, sizeof symbol);
    return function;
}

/// The module stays loaded.
ReadSofa load_module(const std::string& file) {
    void* const module = open_module();
    if (module == nullptr) {
        const char* reason = dlerror();
        throw Error(file,
                    std::string("SOFA files are read by a module that cannot be loaded: ") +
                        (reason == nullptr ? kSofaModule : reason),
                    std::string("install ") + kSofaModule +
                        " beside libearshot.so, with HDF5, or use the default HRIR set");
    }
    const auto version = function_of<SofaVersion>(module, kSofaVersionSymbol);
    const auto read = function_of<ReadSofa>(module, kReadSofaSymbol);
    if (version == nullptr || read == nullptr || version() != ES_VERSION) {
        throw Error(kSofaModule,
                    "is of another version than libearshot.so",
                    "install both from one package");
    }
    return read;
}

}  // namespace

audio::HrirSet read_hrir_set(const char* file, bool raw) {
    const std::string path = file == nullptr ? io::kDefaultHrirSet : file;
    SofaReading reading;
    load_module(path)(path.c_str(), &reading);
    if (reading.has_failed) {
        throw Error(reading.subject, reading.problem, reading.remedy);
    }
    if (!raw) {
        reading.set.centre_delay = audio::common_delay(reading.set);
    }
    return std::move(reading.set);
}

}  // namespace earshot::capi
