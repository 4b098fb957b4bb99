// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/checks.h"

#include <array>
#include <cmath>
#include <cstdio>
#include <type_traits>

namespace earshot::capi {
namespace {

std::string text_of(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%g", value);
    return text.data();
}

/// Whether the bytes are UTF-8 (Unicode 15, table 3-7).
bool is_utf8(std::string_view text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    std::size_t i = 0;
    while (i < text.size()) {
        const unsigned char lead = byte(i);
        const std::size_t length = lead < 0x80   ? 1
                                   : lead < 0xC2 ? 0
                                   : lead < 0xE0 ? 2
                                   : lead < 0xF0 ? 3
                                   : lead < 0xF5 ? 4
                                                 : 0;
        if (length == 0 || i + length > text.size()) {
            return false;
        }
        for (std::size_t k = 1; k < length; ++k) {
            if ((byte(i + k) & 0xC0U) != 0x80U) {
                return false;
            }
        }
        // Overlong forms, surrogates, and what is beyond U+10FFFF.
        if ((lead == 0xE0 && byte(i + 1) < 0xA0) || (lead == 0xED && byte(i + 1) > 0x9F) ||
            (lead == 0xF0 && byte(i + 1) < 0x90) || (lead == 0xF4 && byte(i + 1) > 0x8F)) {
            return false;
        }
        i += length;
    }
    return true;
}

}  // namespace

void fail_null(const char* argument) {
    throw Failure(ES_ERROR_NULL, argument, "is null", "give a pointer");
}

void fail_argument(const std::string& argument,
                   const std::string& problem,
                   const std::string& remedy) {
    throw Failure(ES_ERROR_ARGUMENT, argument, problem, remedy);
}

std::string_view require_text(const char* text, const char* argument) {
    const std::string_view view = &require(text, argument);
    if (!is_utf8(view)) {
        fail_argument(argument, "is not UTF-8", "encode the text as UTF-8");
    }
    return view;
}

std::string_view text_or(const char* text, std::string_view otherwise, const char* argument) {
    return text == nullptr ? otherwise : require_text(text, argument);
}

void require_index(std::size_t index, std::size_t count, const char* argument) {
    if (index >= count) {
        throw Failure(
            ES_ERROR_INDEX,
            argument,
            "is " + std::to_string(index) + ", and there " +
                (count == 0 ? "are none" : "is nothing beyond " + std::to_string(count - 1)),
            count == 0 ? "add one first" : "give an index from 0");
    }
}

void require_in(std::int64_t value,
                std::int64_t lowest,
                std::int64_t highest,
                const char* argument) {
    if (value < lowest || value > highest) {
        const std::string range = std::to_string(lowest) + " ... " + std::to_string(highest);
        fail_argument(
            argument, "is " + std::to_string(value) + ", not in " + range, "give one of " + range);
    }
}

void require_in(double value, double lowest, double highest, const char* argument) {
    if (!(value >= lowest && value <= highest) || !std::isfinite(value)) {
        const std::string range = text_of(lowest) + " ... " + text_of(highest);
        fail_argument(
            argument, "is " + text_of(value) + ", not in " + range, "give a number in " + range);
    }
}

void require_count(std::size_t count,
                   std::size_t lowest,
                   std::size_t highest,
                   const char* argument) {
    if (count < lowest || count > highest) {
        const std::string range = std::to_string(lowest) + " ... " + std::to_string(highest);
        fail_argument(
            argument, "is " + std::to_string(count) + ", not in " + range, "give one of " + range);
    }
}

void require_flag(std::int32_t value, const char* argument) {
    require_in(std::int64_t{value}, 0, 1, argument);
}

void require_finite(std::span<const double> values, const char* argument) {
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (!std::isfinite(values[i])) {
            fail_argument(std::string(argument) + "[" + std::to_string(i) + "]",
                          "is " + text_of(values[i]),
                          "give finite numbers");
        }
    }
}

void require_size(std::size_t given, std::size_t expected, const char* argument) {
    if (given != expected) {
        fail_argument(argument,
                      "is " + std::to_string(given) + ", not " + std::to_string(expected),
                      "give " + std::to_string(expected));
    }
}

std::span<const geometry::Vec3> require_points(const double* points,
                                               std::size_t count,
                                               const char* argument,
                                               std::size_t first) {
    static_assert(sizeof(geometry::Vec3) == 3 * sizeof(double) &&
                  std::is_standard_layout_v<geometry::Vec3>);
    require_array(reinterpret_cast<const geometry::Vec3*>(points), count, argument);
    // Without a branch per number: most calls are right.
    bool are_right = true;
    for (std::size_t i = 0; i < 3 * count; ++i) {
        are_right &= std::abs(points[i]) <= kMaxCoordinate;
    }
    for (std::size_t i = 0; !are_right && i < 3 * count; ++i) {
        if (!(std::abs(points[i]) <= kMaxCoordinate)) {
            fail_argument(std::string(argument) + "[" + std::to_string(first + i / 3) + "]",
                          "has a coordinate of " + text_of(points[i]),
                          "give finite coordinates of at most 1e12 m");
        }
    }
    return {reinterpret_cast<const geometry::Vec3*>(points), count};
}

geometry::Vec3 require_point(const double* point, const char* argument) {
    return require_points(&require(point, argument), 1, argument).front();
}

std::vector<std::array<std::uint32_t, 3>> require_triangles(const std::uint32_t* triangles,
                                                            std::size_t count,
                                                            std::size_t vertex_count,
                                                            const char* argument) {
    using Triangle = std::array<std::uint32_t, 3>;
    const auto given = require_array(reinterpret_cast<const Triangle*>(triangles), count, argument);
    if (count >= ES_NONE) {
        fail_argument(argument, "are more than 2^32 - 2 triangles", "give fewer");
    }
    // The copy is checked: another thread of the caller may write to what was given.
    std::vector<Triangle> copy(given.begin(), given.end());
    for (std::size_t i = 0; i < count; ++i) {
        for (const std::uint32_t vertex : copy[i]) {
            if (vertex >= vertex_count) {
                throw Failure(ES_ERROR_INDEX,
                              std::string(argument) + "[" + std::to_string(i) + "]",
                              "names vertex " + std::to_string(vertex) + " of " +
                                  std::to_string(vertex_count),
                              "give indices of vertices, from 0");
            }
        }
    }
    return copy;
}

}  // namespace earshot::capi
