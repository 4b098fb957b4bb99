// SPDX-License-Identifier: MIT
#include "earshot/io/file_frame.h"

namespace earshot::io {

using geometry::Vec3;

Vec3 FileFrame::to_scene(const Vec3& point) const noexcept {
    const Vec3 turned = up == UpAxis::z ? Vec3(point.x, point.z, -point.y) : point;
    return metres_per_unit == 1.0 ? turned : turned * metres_per_unit;
}

Vec3 FileFrame::to_file(const Vec3& point) const noexcept {
    const Vec3 turned = up == UpAxis::z ? Vec3(point.x, -point.z, point.y) : point;
    return metres_per_unit == 1.0 ? turned : turned / metres_per_unit;
}

const std::vector<LengthUnit>& length_units() {
    // The inch is 25.4 mm by definition (international yard and pound agreement, 1959).
    static const std::vector<LengthUnit> units = {
        {"m", 1.0}, {"cm", 0.01}, {"mm", 0.001}, {"in", 0.0254}, {"ft", 0.3048}};
    return units;
}

std::optional<double> metres_per_unit(std::string_view name) {
    for (const LengthUnit& unit : length_units()) {
        if (unit.name == name) {
            return unit.metres;
        }
    }
    return std::nullopt;
}

}  // namespace earshot::io
