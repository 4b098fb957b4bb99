// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace earshot::propagation::internal {

/// Octave centres of a library row.
inline constexpr std::array<double, 7> kRowHz = {125.0, 250.0, 500.0, 1e3, 2e3, 4e3, 8e3};

/// Energy coefficients at kRowHz.
using Octaves = std::array<double, 7>;

/// Most tables end at 4 kHz: the last value is held at 8 kHz.
constexpr Octaves to_4k(const std::array<double, 6>& value) {
    return {value[0], value[1], value[2], value[3], value[4], value[5], value[5]};
}

/// One value for all bands, as for rough estimates of scattering.
constexpr Octaves everywhere(double value) {
    return {value, value, value, value, value, value, value};
}

/// A material as its table gives it.
struct MaterialRow {
    std::string_view name;
    std::string_view description;
    std::string_view source;
    Octaves absorption{};
    Octaves scattering{};  ///< 0 where the literature gives no estimate
};

// Literature that many rows share; full entries in docs/materials.md.
inline constexpr std::string_view kVorlaender = "Vorlaender 2008, Auralization, Annex";
inline constexpr std::string_view kEgan =
    "Egan 1988, Architectural Acoustics, chapter 2, table of absorption data";
inline constexpr std::string_view kKuttruff = "Kuttruff 2009, Room Acoustics, table 9.1";
inline constexpr std::string_view kHarris =
    "Harris 1991, Handbook of Acoustical Measurements and Noise Control, chapter 30";
inline constexpr std::string_view kBeranek =
    "Beranek & Hidaka 1998, J. Acoust. Soc. Am. 104(6), 3169-3177; Beranek 2004, appendix";
inline constexpr std::string_view kCox =
    "Cox & D'Antonio 2009, Acoustic Absorbers and Diffusers, appendix A";

// The library by groups, in no order that matters; material_library.cpp sorts them by name.
std::span<const MaterialRow> masonry_rows();
std::span<const MaterialRow> lightweight_rows();
std::span<const MaterialRow> floor_rows();
std::span<const MaterialRow> textile_rows();
std::span<const MaterialRow> seating_rows();
std::span<const MaterialRow> absorber_rows();
std::span<const MaterialRow> outdoor_rows();

}  // namespace earshot::propagation::internal
