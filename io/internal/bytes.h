// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

namespace earshot::io {

/// Numbers as bytes, one after another, little-endian on any machine.
class ByteWriter {
public:
    void fixed(std::uint64_t value, int bytes);
    void number(double value);
    /// In seven bits to a byte, the lowest first; the last byte has no top bit.
    void varying(std::uint64_t value);
    void text(std::string_view text);  ///< its length, varying, then itself
    void raw(std::string_view bytes) { bytes_ += bytes; }

    const std::string& bytes() const noexcept { return bytes_; }

private:
    std::string bytes_;
};

/// Reads what ByteWriter writes. Everything throws Error naming the file and the offset if the
/// bytes end too early or a varying number is too long.
class ByteReader {
public:
    ByteReader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {}

    std::uint64_t fixed(int bytes);
    double number();
    std::uint64_t varying();
    std::string text();
    std::string_view raw(std::size_t count);

    /// A varying number of things of at least `bytes_each` bytes that follow: no more than there is
    /// room for, so that a damaged count cannot exhaust the memory.
    std::size_t count(std::size_t bytes_each);

    std::size_t left() const noexcept { return bytes_.size() - offset_; }
    [[noreturn]] void fail(const std::string& what) const;

private:
    std::string_view bytes_;
    std::string file_;
    std::size_t offset_ = 0;
};

}  // namespace earshot::io
