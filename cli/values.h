// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace earshot::cli {

// How values on the command line are written. Numbers are read whole or not at all and the same in
// every locale; an empty result means that the text is not of the form.

std::optional<std::int64_t> parse_integer(std::string_view text);
std::optional<double> parse_number(std::string_view text);  ///< finite

/// Numbers from `min` to `max`.
std::optional<std::int64_t> parse_integer_within(std::string_view text,
                                                 std::int64_t min,
                                                 std::int64_t max);
std::optional<double> parse_number_within(std::string_view text, double min, double max);

/// As many numbers as `numbers` has room for, between separators. False if the text is not of the
/// form, when `numbers` means nothing.
bool parse_numbers(std::string_view text, char separator, std::span<double> numbers);

/// `X,Y,Z` in metres, or `NAME=X,Y,Z`.
struct NamedPoint {
    std::string name;  ///< empty where none is given
    std::array<double, 3> position{};
};
std::optional<NamedPoint> parse_named_point(std::string_view text);

/// `X,Y,Z`.
std::optional<geometry::Vec3> parse_point(std::string_view text);

/// `X,Y,Z:X,Y,Z`, the corners of a box; which is the lower one is not looked at.
std::optional<std::array<geometry::Vec3, 2>> parse_corners(std::string_view text);

/// `WIDTH` or `WIDTHxHEIGHT` in pixels, each 1 ... `max_side`.
struct PictureSize {
    std::int64_t width = 0;
    std::optional<std::int64_t> height{};
};
std::optional<PictureSize> parse_picture_size(std::string_view text, std::int64_t max_side);

/// `A:B:STEP` in seconds: the instants A, A + STEP, ... up to B. STEP is positive, A is not after
/// B, and there are at most 100,000 instants. B counts as reached if rounding alone keeps the last
/// step from it.
std::optional<std::vector<double>> parse_frames(std::string_view text);

}  // namespace earshot::cli
