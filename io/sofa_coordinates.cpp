// SPDX-License-Identifier: MIT
#include "earshot/io/internal/sofa_coordinates.h"

#include "earshot/base/error.h"
#include "earshot/base/math.h"
#include "earshot/io/internal/text.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>

namespace earshot::io {

namespace {

using geometry::Vec3;

// Sines of the angle between view and up below this leave the left undefined: directions in degrees
// with single precision are off by some 1e-7.
constexpr double kMinSine = 1e-4;
// Of view and up, below which their squares lose digits. Their unit has no meaning.
constexpr double kMinLength = 1e-100;

// Of a unit of length or angle, the factor to metres or radians.
struct Unit {
    double factor = 1.0;
    bool is_angle = false;
};

// AES69 has metre, degree and radian; files also write plurals and the American spelling.
std::optional<Unit> unit_of(std::string_view name) {
    std::string word = lower_case(name);
    if (word.size() > 1 && word.back() == 's') {
        word.pop_back();
    }
    if (word == "metre" || word == "meter" || word == "m") {
        return Unit{};
    }
    if (word == "degree" || word == "deg" || word == "\xc2\xb0") {
        return Unit{math::kPi / 180.0, true};
    }
    if (word == "radian" || word == "rad") {
        return Unit{1.0, true};
    }
    return std::nullopt;
}

// What the three components of a vector are to be multiplied by.
struct Scale {
    bool is_spherical = false;
    Vec3 factors{1.0};
};

class ScaleReader {
public:
    ScaleReader(const std::string& file, const std::string& name) : file_(file), name_(name) {}

    Scale read(const SofaVariable& variable, const std::string& default_type) const {
        const auto text = [&](const char* key, const std::string& instead) {
            const auto found = variable.attributes.find(key);
            return found == variable.attributes.end() || found->second.empty() ? instead
                                                                               : found->second;
        };
        const std::string type = lower_case(text("Type", default_type));
        if (type == "cartesian") {
            return cartesian(text("Units", "metre"));
        }
        if (type == "spherical") {
            return spherical(text("Units", "degree, degree, metre"));
        }
        if (type == "spherical harmonics") {
            throw Error(file_,
                        "gives " + name_ + " as spherical harmonics, not as directions",
                        "use a set of measured directions");
        }
        throw Error(
            file_,
            name_ + (type.empty() ? " has no Type" : " has the Type \"" + shortened(type) + "\""),
            "AES69 has cartesian and spherical");
    }

private:
    // One unit for all components, or one for each.
    Scale cartesian(const std::string& units) const {
        const std::vector<std::string_view> words = cells_of(units);
        for (const std::string_view word : words) {
            const auto unit = unit_of(word);
            if (!unit || unit->is_angle) {
                fail(units, "metre");
            }
        }
        return {};
    }

    // Azimuth, elevation, radius; a single angle stands for both angles.
    Scale spherical(const std::string& units) const {
        const std::vector<std::string_view> words = cells_of(units);
        const auto azimuth = unit_of(words.front());
        const auto elevation = unit_of(words[std::min<std::size_t>(1, words.size() - 1)]);
        const auto radius = unit_of(words.size() < 3 ? "metre" : words[2]);
        if (words.size() > 3 || !azimuth || !elevation || !radius || !azimuth->is_angle ||
            !elevation->is_angle || radius->is_angle) {
            fail(units, "\"degree, degree, metre\" or \"radian, radian, metre\"");
        }
        return {true, {azimuth->factor, elevation->factor, 1.0}};
    }

    [[noreturn]] void fail(const std::string& units, const std::string& known) const {
        throw Error(
            file_, name_ + " has the Units \"" + shortened(units) + "\"", "AES69 has " + known);
    }

    const std::string& file_;
    const std::string& name_;
};

Vec3 cartesian(const Scale& scale, const Vec3& components) {
    if (!scale.is_spherical) {
        return components;
    }
    const double azimuth = components.x * scale.factors.x;
    const double elevation = components.y * scale.factors.y;
    const double in_plane = components.z * math::cos(elevation);
    return {in_plane * math::cos(azimuth),
            in_plane * math::sin(azimuth),
            components.z * math::sin(elevation)};
}

}  // namespace

SofaCoordinates::SofaCoordinates(const std::string& file,
                                 const std::string& name,
                                 const SofaVariable& variable,
                                 const std::string& type,
                                 SofaLayout layout,
                                 std::size_t objects,
                                 std::size_t measurements) {
    const Scale scale = ScaleReader(file, name).read(variable, type);
    const std::vector<std::size_t>& shape = variable.shape;
    const bool is_per_object = layout == SofaLayout::per_object;
    const auto is_one_or = [](std::size_t size, std::size_t all) {
        return size == 1 || size == all;
    };
    const bool fits =
        is_per_object
            ? (shape.size() == 2 || (shape.size() == 3 && is_one_or(shape[2], measurements))) &&
                  is_one_or(shape[0], objects) && shape[1] == 3
            : shape.size() == 2 && is_one_or(shape[0], measurements) && shape[1] == 3;
    if (!fits) {
        throw Error(file,
                    name + " does not have the dimensions that AES69 gives it",
                    "export the file again");
    }
    objects_ = is_per_object ? shape[0] : 1;
    measurements_ = !is_per_object ? shape[0] : shape.size() == 3 ? shape[2] : 1;
    const std::vector<double>& values = variable.values;
    if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) {
        throw Error(file, name + " has values that are not finite", "export the file again");
    }
    // Row-major: the components lie side by side, or one row of measurements apart.
    const std::size_t step = is_per_object ? measurements_ : 1;
    for (std::size_t object = 0; object < objects_; ++object) {
        for (std::size_t m = 0; m < measurements_; ++m) {
            const std::size_t first = is_per_object ? object * 3 * step + m : 3 * m;
            vectors_.push_back(
                cartesian(scale, {values[first], values[first + step], values[first + 2 * step]}));
        }
    }
}

Vec3 SofaAxes::into(const Vec3& vector) const {
    return {glm::dot(vector, front), glm::dot(vector, left), glm::dot(vector, up)};
}

Vec3 SofaAxes::out_of(const Vec3& components) const {
    return components.x * front + components.y * left + components.z * up;
}

SofaAxes sofa_axes(const std::string& file,
                   const std::string& name,
                   const Vec3& view,
                   const Vec3& up) {
    const Vec3 side = glm::cross(up, view);
    const double product = std::sqrt(glm::dot(view, view)) * std::sqrt(glm::dot(up, up));
    const double sine_length = std::sqrt(glm::dot(side, side));
    const auto is_short = [](const Vec3& vector) {
        return !(glm::dot(vector, vector) > kMinLength * kMinLength);
    };
    if (is_short(view) || is_short(up) || !(sine_length > kMinSine * product) ||
        !std::isfinite(product)) {
        throw Error(file,
                    name + "View and " + name + "Up do not say where the left is",
                    "export the file again");
    }
    SofaAxes axes;
    axes.front = view / std::sqrt(glm::dot(view, view));
    axes.left = side / sine_length;
    axes.up = glm::cross(axes.front, axes.left);
    return axes;
}

}  // namespace earshot::io
