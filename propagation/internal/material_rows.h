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

/// Scattering coefficients, and the literature or the rule that they come from.
struct RowScattering {
    Octaves values{};
    std::string_view source;
};

/// A material as its table gives it.
struct MaterialRow {
    std::string_view name;
    std::string_view description;
    std::string_view source;
    Octaves absorption{};
    RowScattering scattering{};
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

// Scattering of the literature.
inline constexpr RowScattering kAudience = {
    {0.3, 0.5, 0.6, 0.6, 0.7, 0.7, 0.7}, "Vorlaender 2008, Auralization, Annex: theatre audience"};
inline constexpr RowScattering kClassroomTables = {
    {0.2, 0.3, 0.4, 0.5, 0.5, 0.6, 0.6},
    "Vorlaender 2008, Auralization, Annex: rows of classroom tables and persons on chairs"};
inline constexpr RowScattering kFilledJoints = {
    everywhere(0.08),
    "Christensen & Koutsouris 2013, Odeon user's manual: filled joints, 0.05 to 0.1"};
inline constexpr RowScattering kOpenJoints = {
    everywhere(0.15),
    "Christensen & Koutsouris 2013, Odeon user's manual: open joints, 0.1 to 0.2"};

// Where the literature has none: estimates of ours. Depths are estimates too; the formula is that
// of Postma and Katz 2015 (of CATT-Acoustic), which limits it to 0.1 and more.
inline constexpr RowScattering kFlat = {everywhere(0.1),
                                        "estimate: 0.1 for flat surfaces, in all bands"};
inline constexpr RowScattering kPolished = {
    everywhere(0.05), "estimate: 0.05 for smooth hard surfaces, in all bands"};
inline constexpr RowScattering kDepth10mm = {
    {0.05, 0.05, 0.06, 0.09, 0.12, 0.17, 0.24},
    "estimate: 0.5 sqrt(depth / wavelength), at least 0.05, of a structure 10 mm deep"};
inline constexpr RowScattering kDepth50mm = {
    {0.07, 0.1, 0.13, 0.19, 0.27, 0.38, 0.54},
    "estimate: 0.5 sqrt(depth / wavelength), at least 0.05, of a structure 50 mm deep"};
inline constexpr RowScattering kDepth100mm = {
    {0.1, 0.13, 0.19, 0.27, 0.38, 0.54, 0.76},
    "estimate: 0.5 sqrt(depth / wavelength), at least 0.05, of a structure 100 mm deep"};
inline constexpr RowScattering kLikeAudience = {
    kAudience.values, "estimate: as theatre audience (Vorlaender 2008, Auralization, Annex)"};
inline constexpr RowScattering kNoReflection = {everywhere(0.0),
                                                "estimate: 0, as nothing is reflected"};

// The library by groups, in no order that matters; material_library.cpp sorts them by name.
std::span<const MaterialRow> masonry_rows();
std::span<const MaterialRow> lightweight_rows();
std::span<const MaterialRow> floor_rows();
std::span<const MaterialRow> textile_rows();
std::span<const MaterialRow> seating_rows();
std::span<const MaterialRow> absorber_rows();
std::span<const MaterialRow> outdoor_rows();

}  // namespace earshot::propagation::internal
