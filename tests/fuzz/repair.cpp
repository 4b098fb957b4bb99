// SPDX-License-Identifier: MIT
#include "fuzz/repair.h"

#include "earshot/base/digest.h"

#include <cstdint>
#include <span>
#include <string_view>

namespace earshot::test {
namespace {

/// Little-endian.
void put(std::string& bytes, std::size_t at, std::uint64_t value, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
        bytes[at + i] = static_cast<char>(value >> 8 * i & 0xFFU);
    }
}

}  // namespace

std::string repair_glb(std::string bytes) {
    constexpr std::size_t kHeader = 12, kChunkHeader = 8;
    constexpr std::size_t kJson = kHeader + kChunkHeader;
    if (bytes.size() < kJson || !bytes.starts_with("glTF")) {
        return bytes;
    }
    put(bytes, 8, bytes.size(), 4);
    // The binary chunk begins with its length and its type.
    const std::size_t type = bytes.find(std::string_view("BIN\0", 4), kJson + 4);
    const bool has_binary = type != std::string::npos;
    put(bytes, kHeader, (has_binary ? type - 4 : bytes.size()) - kJson, 4);
    if (has_binary) {
        put(bytes, type - 4, bytes.size() - type - 4, 4);
    }
    return bytes;
}

std::string repair_stl(std::string bytes) {
    constexpr std::size_t kHeader = 84, kFacet = 50;
    if (bytes.size() >= kHeader && !bytes.starts_with("solid")) {
        put(bytes, kHeader - 4, (bytes.size() - kHeader) / kFacet, 4);
    }
    return bytes;
}

std::string repair_visible_sets(std::string bytes) {
    constexpr std::size_t kChecksum = 8;
    if (bytes.size() >= kChecksum) {
        const std::size_t end = bytes.size() - kChecksum;
        Digest digest;
        digest.add_bytes(std::as_bytes(std::span(bytes).first(end)));
        put(bytes, end, digest.value(), kChecksum);
    }
    return bytes;
}

std::string repair_wav(std::string bytes) {
    constexpr std::size_t kHeader = 8;
    if (bytes.size() >= kHeader && bytes.starts_with("RIFF")) {
        put(bytes, 4, bytes.size() - kHeader, 4);
    }
    return bytes;
}

}  // namespace earshot::test
