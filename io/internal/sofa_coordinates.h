// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/geometry/types.h"
#include "earshot/io/internal/sofa_file.h"

#include <cstddef>
#include <string>
#include <vector>

namespace earshot::io {

/// Which of its dimensions a variable of coordinates has (AES69, letters of dimensions).
enum class SofaLayout {
    per_measurement,  ///< IC or MC
    per_object        ///< RC, RCI or RCM of receivers; EC, ECI or ECM of emitters; IC, ICI of one
};

/// The vectors of a variable, in metres and Cartesian (front, left, up), whatever its type and
/// units.
class SofaCoordinates {
public:
    /// One vector for all.
    explicit SofaCoordinates(const geometry::Vec3& vector) : vectors_{vector} {}

    /// Throws Error naming the file if the variable has another shape, values that are not finite,
    /// or a type or units that AES69 does not have. `type`: where the variable gives none.
    /// `objects`, `measurements`: as many as there may be beside one for all.
    SofaCoordinates(const std::string& file,
                    const std::string& name,
                    const SofaVariable& variable,
                    const std::string& type,
                    SofaLayout layout,
                    std::size_t objects,
                    std::size_t measurements);

    /// Of an object (0 where the layout has none) in a measurement.
    const geometry::Vec3& at(std::size_t object, std::size_t measurement) const {
        return vectors_[(objects_ == 1 ? 0 : object) * measurements_ +
                        (measurements_ == 1 ? 0 : measurement)];
    }

private:
    std::vector<geometry::Vec3> vectors_;  ///< a row of measurements per object
    std::size_t objects_ = 1;
    std::size_t measurements_ = 1;
};

/// Axes of an object in the axes that it stands in.
struct SofaAxes {
    geometry::Vec3 front{1.0, 0.0, 0.0};
    geometry::Vec3 left{0.0, 1.0, 0.0};
    geometry::Vec3 up{0.0, 0.0, 1.0};

    /// Front, left, up components of a vector.
    geometry::Vec3 into(const geometry::Vec3& vector) const;
    /// The vector with these front, left, up components.
    geometry::Vec3 out_of(const geometry::Vec3& components) const;
};

/// The axes of what looks along `view` with `up` upwards, both of any length: `view` is kept and
/// `up` put at right angles to it. Throws Error naming the file if they span no plane. `name`: of
/// the object, "Listener".
SofaAxes sofa_axes(const std::string& file,
                   const std::string& name,
                   const geometry::Vec3& view,
                   const geometry::Vec3& up);

}  // namespace earshot::io
