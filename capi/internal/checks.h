// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/internal/failure.h"
#include "earshot/geometry/types.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::capi {

// What callers give is checked by these: each throws Failure, which names the argument.

[[noreturn]] void fail_null(const char* argument);
[[noreturn]] void fail_argument(const std::string& argument,
                                const std::string& problem,
                                const std::string& remedy);

template <typename T>
T& require(T* pointer, const char* argument) {
    if (pointer == nullptr) {
        fail_null(argument);
    }
    return *pointer;
}

/// An array that may be null only if it is empty, and whose size in bytes is sensible.
template <typename T>
std::span<T> require_array(T* pointer, std::size_t count, const char* argument) {
    constexpr std::size_t kMaxBytes = std::size_t{1} << 46U;
    if (count > kMaxBytes / sizeof(T)) {
        fail_argument(
            argument, "has a size of " + std::to_string(count) + " elements", "check the count");
    }
    if (pointer == nullptr && count > 0) {
        fail_null(argument);
    }
    return {pointer, count};
}

/// The text, or what stands for none where null is allowed.
std::string_view require_text(const char* text, const char* argument);
std::string_view text_or(const char* text, std::string_view otherwise, const char* argument);

void require_index(std::size_t index, std::size_t count, const char* argument);
void require_in(std::int64_t value,
                std::int64_t lowest,
                std::int64_t highest,
                const char* argument);
/// Finite numbers only.
void require_in(double value, double lowest, double highest, const char* argument);
void require_count(std::size_t count,
                   std::size_t lowest,
                   std::size_t highest,
                   const char* argument);
void require_flag(std::int32_t value, const char* argument);
void require_finite(std::span<const double> values, const char* argument);
void require_size(std::size_t given, std::size_t expected, const char* argument);

/// Metres; coordinates beyond this are taken for mistakes, as the readers of files do.
inline constexpr double kMaxCoordinate = 1e12;

/// Points of (count, 3) coordinates that are finite and at most kMaxCoordinate; `first` is the
/// number of the first of them to the caller.
std::span<const geometry::Vec3> require_points(const double* points,
                                               std::size_t count,
                                               const char* argument,
                                               std::size_t first = 0);
geometry::Vec3 require_point(const double* point, const char* argument);

/// Triangles of vertices that there are.
std::vector<std::array<std::uint32_t, 3>> require_triangles(const std::uint32_t* triangles,
                                                            std::size_t count,
                                                            std::size_t vertex_count,
                                                            const char* argument);

/// A struct that begins with its size, of this version of the library or an older one: members that
/// it lacks are those of `defaults`. `first_size`: of the first version.
template <typename T>
T require_struct(const T& given, const T& defaults, std::size_t first_size, const char* argument) {
    const std::size_t size = given.struct_size;
    if (size < first_size || size > sizeof(T)) {
        fail_argument(
            std::string(argument) + "->struct_size",
            "is " + std::to_string(size) + ", not " + std::to_string(sizeof(T)),
            "set it to sizeof the struct, and use the library of the header or a newer one");
    }
    T whole = defaults;
    std::memcpy(&whole, &given, size);
    return whole;
}

/// Gives a caller as much of a struct as the caller knows.
template <typename T>
void give_struct(T value, T* out, std::size_t first_size, const char* argument) {
    T& target = require(out, argument);
    const std::size_t size = require_struct(target, T{}, first_size, argument).struct_size;
    value.struct_size = size;
    std::memcpy(&target, &value, size);
}

/// Defaults into a caller's struct of `size` bytes.
template <typename T>
void init_struct(T defaults, T* out, std::size_t size, std::size_t first_size) {
    T& target = require(out, "the struct");
    defaults.struct_size = size;
    static_cast<void>(require_struct(defaults, T{}, first_size, "the struct"));
    std::memcpy(&target, &defaults, size);
}

}  // namespace earshot::capi
