// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace earshot::io {

/// Serialises numbers one after another, little-endian on any machine.
class ByteWriter {
public:
    void fixed(std::uint64_t value, int bytes);
    void number(double value);
    /// Unsigned LEB128 (DWARF 5 section 7.6): seven bits to a byte, the lowest first; the last byte
    /// has no top bit.
    void leb128(std::uint64_t value);
    void string(std::string_view text);  ///< its length as LEB128, then its bytes
    void raw(std::string_view bytes) { bytes_ += bytes; }

    const std::string& bytes() const noexcept { return bytes_; }

private:
    std::string bytes_;
};

/// Reads what ByteWriter writes. Every function throws Error naming the file and the offset if the
/// bytes end too early or a LEB128 number is longer than 64 bits.
class ByteReader {
public:
    ByteReader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

    std::uint64_t fixed(int bytes);
    double number();
    std::uint64_t leb128();
    std::string string();
    std::string_view raw(std::size_t count);

    /// Reads a LEB128 count of records of at least `bytes_each` bytes and checks it against the
    /// bytes that remain, so that a damaged count cannot exhaust the memory.
    std::size_t count(std::size_t bytes_each);

    std::size_t remaining() const noexcept { return bytes_.size() - offset_; }
    [[noreturn]] void fail(const std::string& what) const;

private:
    std::string_view bytes_;
    std::string file_;
    std::size_t offset_ = 0;
};

}  // namespace earshot::io
