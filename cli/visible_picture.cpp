// SPDX-License-Identifier: MIT
#include "earshot/cli/visible_picture.h"

#include "earshot/cli/formatted.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::cli {

using visibility::ItemBuffer;
using visibility::kNoTriangle;

namespace {

/// Number i of an even sequence over 0 ... 1: multiples of an irrational `step` / 2^32.
double spread(std::uint32_t i, std::uint32_t step) noexcept {
    return static_cast<double>((i + 1) * step) * 0x1p-32;
}

std::uint8_t to_byte(double value) noexcept {
    return static_cast<std::uint8_t>(std::clamp(value, 0.0, 1.0) * 255.0 + 0.5);
}

template <typename ColourOf>
io::Picture paint(const ItemBuffer& buffer, const ColourOf& colour_of_pixel) {
    io::Picture picture{.width = buffer.view.width, .height = buffer.view.height, .rgb = {}};
    picture.rgb.reserve(3 * buffer.triangles.size());
    for (std::size_t i = 0; i < buffer.triangles.size(); ++i) {
        const Colour colour = buffer.triangles[i] == kNoTriangle ? Colour{} : colour_of_pixel(i);
        picture.rgb.insert(picture.rgb.end(), colour.begin(), colour.end());
    }
    return picture;
}

}  // namespace

Colour colour_of(std::uint32_t number) noexcept {
    // Multiples of the golden ratio and of powers of the plastic number are far apart.
    const double hue = 6.0 * spread(number, 0x9E3779B9U);
    const double value = 0.65 + 0.35 * spread(number, 0xC13FA9A9U);
    const double saturation = 0.35 + 0.5 * spread(number, 0x91E10DA5U);
    Colour colour{};
    for (std::size_t k = 0; k < 3; ++k) {
        // Red, green and blue are each full over a third of the hues.
        const double turn = std::fmod(hue + 6.0 - 2.0 * static_cast<double>(k), 6.0);
        const double full = std::clamp(std::abs(turn - 3.0) - 1.0, 0.0, 1.0);
        colour[k] = to_byte(value * (1.0 - saturation * (1.0 - full)));
    }
    return colour;
}

std::string name_of(const Colour& colour) {
    return formatted("#%02x%02x%02x", colour[0], colour[1], colour[2]);
}

io::Picture paint_triangles(const ItemBuffer& buffer) {
    return paint(buffer, [&](std::size_t i) { return colour_of(buffer.triangles[i]); });
}

io::Picture paint_materials(const ItemBuffer& buffer,
                            const geometry::MeshView& mesh,
                            std::span<const std::uint32_t> material_of_triangle) {
    return paint(buffer, [&](std::size_t i) {
        const auto [a, b, c] = geometry::corners(mesh, buffer.triangles[i]);
        const geometry::Vec3 normal = glm::cross(b - a, c - a);
        const double facing =
            std::abs(glm::dot(normal, buffer.directions[i])) / std::sqrt(glm::dot(normal, normal));
        Colour colour = colour_of(material_of_triangle[buffer.triangles[i]]);
        for (std::uint8_t& part : colour) {
            part = to_byte((0.4 + 0.6 * facing) * part / 255.0);
        }
        return colour;
    });
}

io::Picture paint_depths(const ItemBuffer& buffer, double range) {
    return paint(buffer, [&](std::size_t i) {
        constexpr double kFall = 240.0;
        const double part = range > 0.0 ? std::min(1.0, buffer.distances[i] / range) : 0.0;
        const auto grey = static_cast<std::uint8_t>(255.5 - kFall * part);
        return Colour{grey, grey, grey};
    });
}

double farthest(const ItemBuffer& buffer) noexcept {
    double most = 0.0;
    for (const double distance : buffer.distances) {
        most = std::isfinite(distance) ? std::max(most, distance) : most;
    }
    return most;
}

}  // namespace earshot::cli
