// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"

#include <cstdint>
#include <string>

namespace earshot::capi {

// SOFA files are read by HDF5, which brings a network stack along. It is in a module of its own,
// libearshot-sofa.so, that is loaded when the first of them is read. Both are made by one build.

/// What the module has read, or why it has not.
struct SofaReading {
    audio::HrirSet set{};
    bool has_failed = false;
    std::string subject{}, problem{}, remedy{};
};

/// The module's version, as ES_VERSION.
using SofaVersion = std::uint32_t (*)();
/// Reads a file; never throws.
using ReadSofa = void (*)(const char* file, SofaReading* reading);

inline constexpr const char* kSofaModule = "libearshot-sofa.so";
inline constexpr const char* kSofaVersionSymbol = "earshot_sofa_version";
inline constexpr const char* kReadSofaSymbol = "earshot_sofa_read";

}  // namespace earshot::capi
