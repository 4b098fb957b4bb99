// SPDX-License-Identifier: MIT
#include "earshot/propagation/directivity.h"

#include "earshot/base/assert.h"
#include "earshot/base/error.h"
#include "earshot/base/math.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

namespace earshot::propagation {

using audio::Spectrum;

namespace {

constexpr double kDegree = math::kPi / 180.0;

void check_axis(std::span<const double> axis,
                double min_value,
                double max_value,
                const char* name) {
    bool sound = !axis.empty();
    for (std::size_t i = 0; i < axis.size(); ++i) {
        sound = sound && axis[i] >= min_value && axis[i] <= max_value &&
                (i == 0 || axis[i - 1] < axis[i]);
    }
    if (!sound) {
        throw Error(std::string("directivity: ") + name,
                    "must increase within " + std::to_string(std::lround(min_value)) + " ... " +
                        std::to_string(std::lround(max_value)),
                    "sort the table");
    }
}

/// Between which entries of an axis a value lies, and where.
struct Place {
    std::size_t below = 0, above = 0;
    double share = 0.0;  // of `above`
};

Place place_on(std::span<const double> axis, double value) {
    const auto next =
        static_cast<std::size_t>(std::lower_bound(axis.begin(), axis.end(), value) - axis.begin());
    if (next == 0) {
        return {0, 0, 0.0};
    }
    if (next == axis.size()) {
        return {next - 1, next - 1, 0.0};
    }
    return {next - 1, next, (value - axis[next - 1]) / (axis[next] - axis[next - 1])};
}

/// The last entry's successor is the first, 360 degrees on.
Place place_on_circle(std::span<const double> axis, double value) {
    if (value >= axis.front() && value <= axis.back()) {
        return place_on(axis, value);
    }
    const double gap = axis.front() + 360.0 - axis.back();
    const double past = value > axis.back() ? value - axis.back() : value + 360.0 - axis.back();
    return {axis.size() - 1, 0, past / gap};
}

double between(double a, double b, double share) {
    return a + share * (b - a);
}

}  // namespace

Directivity Directivity::first_order(double omni_share) {
    EARSHOT_ASSERT(omni_share >= 0.0 && omni_share <= 1.0);
    Directivity directivity;
    directivity.omni_share_ = omni_share;
    return directivity;
}

std::optional<Directivity> Directivity::named(std::string_view name) {
    struct Entry {
        std::string_view name;
        double omni_share;
    };
    constexpr std::array<Entry, 6> kFamily = {{{"omni", 1.0},
                                               {"subcardioid", 0.7},
                                               {"cardioid", 0.5},
                                               {"supercardioid", 0.37},
                                               {"hypercardioid", 0.25},
                                               {"figure-of-eight", 0.0}}};
    for (const Entry& entry : kFamily) {
        if (entry.name == name) {
            return first_order(entry.omni_share);
        }
    }
    return std::nullopt;
}

Directivity Directivity::tabulated(DirectivityTable table) {
    check_axis(table.frequencies_hz, 1e-3, 1e6, "frequencies");
    check_axis(table.azimuths, 0.0, std::nextafter(360.0, 0.0), "azimuths");
    check_axis(table.elevations, -90.0, 90.0, "elevations");
    const std::size_t directions = table.azimuths.size() * table.elevations.size();
    constexpr double kLoudest = 200.0;  // decibels
    if (table.levels_db.size() != directions * table.frequencies_hz.size() ||
        !std::all_of(table.levels_db.begin(), table.levels_db.end(), [](double level) {
            return std::isfinite(level) && level <= kLoudest;
        })) {
        throw Error("directivity: levels", "are missing, not finite or too large", "see the docs");
    }
    Directivity directivity;
    for (const double frequency_hz : table.frequencies_hz) {
        directivity.logarithms_.push_back(math::log(frequency_hz));
    }
    directivity.table_ = std::move(table);
    return directivity;
}

Spectrum Directivity::pressure(const audio::Bands& bands, const geometry::Vec3& towards) const {
    Spectrum pressure{};
    if (table_.levels_db.empty()) {
        std::fill_n(pressure.begin(), bands.count(), omni_share_ + (1.0 - omni_share_) * towards.x);
        return pressure;
    }
    const double turn = math::atan2(towards.y, towards.x) / kDegree;
    const double height = math::asin(std::clamp(towards.z, -1.0, 1.0)) / kDegree;
    const Place column = place_on_circle(table_.azimuths, turn < 0.0 ? turn + 360.0 : turn);
    const Place row = place_on(table_.elevations, height);
    const std::size_t columns = table_.azimuths.size();
    const auto level = [&](std::size_t frequency) {
        const double* grid =
            table_.levels_db.data() + frequency * columns * table_.elevations.size();
        const auto along = [&](std::size_t i) {
            return between(
                grid[i * columns + column.below], grid[i * columns + column.above], column.share);
        };
        return between(along(row.below), along(row.above), row.share);
    };
    for (std::size_t band = 0; band < bands.count(); ++band) {
        const Place place = place_on(logarithms_, math::log(bands.exact_hz()[band]));
        pressure[band] =
            math::pow10(between(level(place.below), level(place.above), place.share) / 20.0);
    }
    return pressure;
}

double Directivity::loudest() const noexcept {
    if (table_.levels_db.empty()) {
        return 1.0;
    }
    constexpr double kRounding = 1.0 + 0x1p-40;
    const double level = *std::max_element(table_.levels_db.begin(), table_.levels_db.end());
    return kRounding * math::pow10(level / 20.0);
}

}  // namespace earshot::propagation
