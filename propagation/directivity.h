// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/geometry/types.h"

#include <optional>
#include <string_view>
#include <vector>

namespace earshot::propagation {

/// Levels of a source over a grid of directions.
struct DirectivityTable {
    std::vector<double> frequencies_hz;  ///< increasing, at least one
    /// Degrees, increasing, within 0 ... 360 without the end: counted from the front to the left.
    std::vector<double> azimuths;
    std::vector<double> elevations;  ///< degrees, increasing, within -90 ... 90
    /// Decibels re in front, frequency after frequency, elevation after elevation, azimuth after
    /// azimuth.
    std::vector<double> levels_db;
};

/// How strongly a source radiates into each direction: pressure re in front.
class Directivity {
public:
    /// Into all directions alike.
    Directivity() = default;

    /// The family omni_share + (1 - omni_share) * cos(angle off the front); negative pressure is of
    /// the other sign. Precondition: 0 <= omni_share <= 1.
    static Directivity first_order(double omni_share);

    /// "omni", "subcardioid", "cardioid", "supercardioid", "hypercardioid", "figure-of-eight" (omni
    /// shares 1, 0.7, 0.5, 0.37, 0.25, 0); nothing for another name.
    static std::optional<Directivity> named(std::string_view name);

    /// Measured levels, between the grid's directions bilinear in decibels, held beyond its first
    /// and last elevation; between frequencies linear in decibels over their logarithm, held at the
    /// ends. Throws Error if the table is incomplete, out of range or not finite.
    static Directivity tabulated(DirectivityTable table);

    bool is_omnidirectional() const noexcept {
        return omni_share_ == 1.0 && table_.levels_db.empty();
    }

    /// Pressure re in front per band. `towards`: front, left, up components of the unit vector of
    /// departure.
    audio::Spectrum pressure(const audio::Bands& bands, const geometry::Vec3& towards) const;

    /// No pressure() is larger.
    double loudest() const noexcept;

private:
    double omni_share_ = 1.0;
    DirectivityTable table_;          // empty: the family
    std::vector<double> logarithms_;  // of the table's frequencies
};

}  // namespace earshot::propagation
