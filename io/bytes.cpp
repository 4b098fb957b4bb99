// SPDX-License-Identifier: MIT
#include "earshot/io/internal/bytes.h"

#include "earshot/base/error.h"

#include <bit>

namespace earshot::io {

void ByteWriter::fixed(std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) {
        bytes_.push_back(static_cast<char>(value >> 8 * i & 0xffU));
    }
}

void ByteWriter::number(double value) {
    fixed(std::bit_cast<std::uint64_t>(value), 8);
}

void ByteWriter::leb128(std::uint64_t value) {
    for (; value > 0x7fU; value >>= 7) {
        bytes_.push_back(static_cast<char>((value & 0x7fU) | 0x80U));
    }
    bytes_.push_back(static_cast<char>(value));
}

void ByteWriter::string(std::string_view text) {
    leb128(text.size());
    bytes_ += text;
}

std::uint64_t ByteReader::fixed(int bytes) {
    const std::string_view taken = raw(static_cast<std::size_t>(bytes));
    std::uint64_t value = 0;
    for (int i = 0; i < bytes; ++i) {
        value |= std::uint64_t{static_cast<unsigned char>(taken[static_cast<std::size_t>(i)])}
                 << 8 * i;
    }
    return value;
}

double ByteReader::number() {
    return std::bit_cast<double>(fixed(8));
}

std::uint64_t ByteReader::leb128() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
        const std::uint64_t byte = fixed(1);
        const std::uint64_t part = byte & 0x7fU;
        if (shift == 63 && part > 1) {
            break;
        }
        value |= part << shift;
        if (byte < 0x80U) {
            return value;
        }
    }
    fail("a number is too long");
}

std::string ByteReader::string() {
    const std::size_t length = count(1);
    return std::string(raw(length));
}

std::string_view ByteReader::raw(std::size_t count) {
    if (count > remaining()) {
        fail("it is truncated");
    }
    const std::string_view taken = bytes_.substr(offset_, count);
    offset_ += count;
    return taken;
}

std::size_t ByteReader::count(std::size_t bytes_each) {
    const std::uint64_t value = leb128();
    if (value > remaining() / bytes_each) {
        fail("it has less data than it states");
    }
    return static_cast<std::size_t>(value);
}

void ByteReader::fail(const std::string& what) const {
    throw Error(file_,
                "byte " + std::to_string(offset_) + ": " + what,
                "the file is damaged; create it again");
}

}  // namespace earshot::io
