// SPDX-License-Identifier: MIT
// The fuzzer of the reader EARSHOT_FUZZ_READER, for libFuzzer.
#include "fuzz/readers.h"
#include <cstddef>
#include <cstdint>
#include <cstring>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t capacity);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const earshot::test::Reader& reader = earshot::test::reader_named(EARSHOT_FUZZ_READER);
    earshot::test::fuzz_one(reader, {reinterpret_cast<const char*>(data), size});
    return 0;
}

// libFuzzer's own mutation; 15 of 16 are repaired.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                               std::size_t size,
                                               std::size_t capacity,
                                               unsigned seed) {
    static const earshot::test::Reader& reader = earshot::test::reader_named(EARSHOT_FUZZ_READER);
    size = LLVMFuzzerMutate(data, size, capacity);
    if (reader.repair != nullptr && seed % 16 != 0) {
        const std::string repaired = reader.repair({reinterpret_cast<const char*>(data), size});
        std::memcpy(data, repaired.data(), size);
    }
    return size;
}
