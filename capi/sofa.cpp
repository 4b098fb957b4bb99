// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/sofa.h"

#include "earshot/base/error.h"
#include "earshot/capi/earshot.h"
#include "earshot/capi/internal/sofa_module.h"
#include "earshot/io/sofa.h"

#include <cstring>
#include <dlfcn.h>
#include <filesystem>
#include <string>
#include <system_error>
#include <utility>

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

/// The functions of the module, which stays loaded.
struct Module {
    ReadSofa read = nullptr;
    WriteSofa write = nullptr;
};

/// Throws Error naming the file that it is loaded for.
Module load_module(const std::string& file) {
    void* const module = open_module();
    if (module == nullptr) {
        const char* reason = dlerror();
        throw Error(file,
                    std::string("SOFA files are read and written by a module that cannot be "
                                "loaded: ") +
                        (reason == nullptr ? kSofaModule : reason),
                    std::string("install ") + kSofaModule +
                        " beside libearshot.so, with HDF5, or do without SOFA files");
    }
    const auto version = function_of<SofaVersion>(module, kSofaVersionSymbol);
    const Module functions = {.read = function_of<ReadSofa>(module, kReadSofaSymbol),
                              .write = function_of<WriteSofa>(module, kWriteSofaSymbol)};
    if (version == nullptr || functions.read == nullptr || functions.write == nullptr ||
        version() != ES_VERSION) {
        throw Error(kSofaModule,
                    "is of another version than libearshot.so",
                    "install both from one package");
    }
    return functions;
}

void throw_if_failed(const SofaFailure& failure, const std::string& file) {
    if (failure.has_failed) {
        throw Error(
            failure.subject.empty() ? file : failure.subject, failure.problem, failure.remedy);
    }
}

}  // namespace

audio::HrirSet read_hrir_set(const char* file, bool raw) {
    const std::string path = file == nullptr ? io::kDefaultHrirSet : file;
    SofaReading reading;
    load_module(path).read(path.c_str(), &reading);
    throw_if_failed(reading.failure, path);
    if (!raw) {
        reading.set.centre_delay = audio::common_delay(reading.set);
    }
    return std::move(reading.set);
}

std::string encode_room_responses(const std::string& file,
                                  const std::string& title,
                                  propagation::Channels kind,
                                  const std::vector<io::RoomMeasurement>& measurements) {
    SofaWriting writing = {.title = title, .kind = kind, .measurements = measurements};
    load_module(file).write(&writing);
    throw_if_failed(writing.failure, file);
    return std::move(writing.bytes);
}

}  // namespace earshot::capi
