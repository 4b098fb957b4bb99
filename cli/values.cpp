// SPDX-License-Identifier: MIT
#include "earshot/cli/values.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

namespace earshot::cli {
namespace {

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
    if (text.starts_with('+')) {
        text.remove_prefix(1);
    }
    Number value{};
    const char* const end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, value);
    if (error != std::errc() || stopped != end) {
        return std::nullopt;
    }
    return value;
}

template <typename Number>
std::optional<Number> within(std::optional<Number> value, Number min, Number max) {
    return value && *value >= min && *value <= max ? value : std::nullopt;
}

}  // namespace

std::optional<std::int64_t> parse_integer(std::string_view text) {
    return parse_whole<std::int64_t>(text);
}

std::optional<double> parse_number(std::string_view text) {
    const std::optional<double> value = parse_whole<double>(text);
    return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<std::int64_t> parse_integer_within(std::string_view text,
                                                 std::int64_t min,
                                                 std::int64_t max) {
    return within(parse_integer(text), min, max);
}

std::optional<double> parse_number_within(std::string_view text, double min, double max) {
    return within(parse_number(text), min, max);
}

bool parse_numbers(std::string_view text, char separator, std::span<double> numbers) {
    for (std::size_t i = 0; i < numbers.size(); ++i) {
        const std::size_t end = text.find(separator);
        const bool is_last = i + 1 == numbers.size();
        const std::optional<double> number = parse_number(text.substr(0, end));
        if (!number || (end == std::string_view::npos) != is_last) {
            return false;
        }
        numbers[i] = *number;
        text.remove_prefix(is_last ? text.size() : end + 1);
    }
    return true;
}

std::optional<NamedPoint> parse_named_point(std::string_view text) {
    NamedPoint point;
    const std::size_t equals = text.find('=');
    if (equals != std::string_view::npos) {
        if (equals == 0) {
            return std::nullopt;
        }
        point.name = text.substr(0, equals);
        text.remove_prefix(equals + 1);
    }
    return parse_numbers(text, ',', point.position) ? std::optional(point) : std::nullopt;
}

std::optional<geometry::Vec3> parse_point(std::string_view text) {
    std::array<double, 3> position{};
    return parse_numbers(text, ',', position)
               ? std::optional(geometry::Vec3(position[0], position[1], position[2]))
               : std::nullopt;
}

std::optional<std::array<geometry::Vec3, 2>> parse_corners(std::string_view text) {
    const std::size_t colon = text.find(':');
    if (colon == std::string_view::npos) {
        return std::nullopt;
    }
    const auto first = parse_point(text.substr(0, colon));
    const auto second = parse_point(text.substr(colon + 1));
    return first && second ? std::optional(std::array{*first, *second}) : std::nullopt;
}

std::optional<PictureSize> parse_picture_size(std::string_view text, std::int64_t max_side) {
    const std::size_t cross = text.find('x');
    const auto width = parse_integer_within(text.substr(0, cross), 1, max_side);
    if (!width) {
        return std::nullopt;
    }
    PictureSize size{.width = *width};
    if (cross != std::string_view::npos) {
        size.height = parse_integer_within(text.substr(cross + 1), 1, max_side);
        if (!size.height) {
            return std::nullopt;
        }
    }
    return size;
}

std::optional<std::vector<double>> parse_frames(std::string_view text) {
    // Rounding of (B - A) / STEP is a few 2^-53 of at most 100,000 steps, so far below this.
    constexpr double kStepRounding = 1e-9;
    constexpr double kMaxSteps = 99'999.0;
    std::array<double, 3> range{};
    if (!parse_numbers(text, ':', range)) {
        return std::nullopt;
    }
    const auto [first, last, step] = range;
    const double steps = std::floor((last - first) / step + kStepRounding);
    if (!(step > 0.0) || !(first <= last) || !(steps <= kMaxSteps)) {
        return std::nullopt;
    }
    std::vector<double> instants;
    for (int i = 0; i <= static_cast<int>(steps); ++i) {
        instants.push_back(first + i * step);
    }
    return instants;
}

}  // namespace earshot::cli
