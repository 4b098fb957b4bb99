// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/hrir_set.h"
#include "earshot/io/room_sofa.h"
#include "earshot/propagation/response.h"

#include <cstdint>
#include <string>
#include <vector>

namespace earshot::capi {

// SOFA files are read and written by HDF5, which brings a network stack along. It is in a module of
// its own, libearshot-sofa.so, that is loaded when the first of them is used. Both are made by one
// build. Functions of the module never throw, and one runs at a time, as HDF5 demands.

/// Why the module has failed.
struct SofaFailure {
    bool has_failed = false;
    std::string subject{}, problem{}, remedy{};
};

/// What the module has read.
struct SofaReading {
    audio::HrirSet set{};
    SofaFailure failure{};
};

/// What the module writes, and the bytes that come of it.
struct SofaWriting {
    const std::string& title;
    propagation::Channels kind;
    const std::vector<io::RoomMeasurement>& measurements;
    std::string bytes{};
    SofaFailure failure{};
};

/// The module's version, as ES_VERSION.
using SofaVersion = std::uint32_t (*)();
using ReadSofa = void (*)(const char* file, SofaReading* reading);
using WriteSofa = void (*)(SofaWriting* writing);

inline constexpr const char* kSofaModule = "libearshot-sofa.so";
inline constexpr const char* kSofaVersionSymbol = "earshot_sofa_version";
inline constexpr const char* kReadSofaSymbol = "earshot_sofa_read";
inline constexpr const char* kWriteSofaSymbol = "earshot_sofa_write";

}  // namespace earshot::capi
