// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/frustum/edge_paths.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/wedge.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/pair_result.h"

#include <array>
#include <complex>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// Facets in the order in which a path meets them.
using FacetSequence = std::vector<geometry::FacetId>;

/// The specular paths of a pair that are only reflected, by their facets: index into its paths.
using SpecularPaths = std::map<FacetSequence, std::size_t>;

/// What diffraction needs to know of a scene.
struct DiffractionModel {
    const audio::Bands& bands;
    double speed_of_sound = 0.0;
    const AirAbsorption& air;
    bool air_absorption = true;
    std::span<const audio::Spectrum> reflection;  ///< pressure factor per facet
    /// Of specular paths: terms that mend paths with more reflections are left out, as these are.
    int max_order = 0;
};

/// The sound of one edge path. Each of the three kinds of terms mends the specular path that has
/// the same reflections before and after the edge, and at the edge none or one in a face.
struct DiffractedSound {
    frustum::EdgePath way;
    std::array<FacetSequence, 3> mended;  ///< empty and counted: the direct path
    std::array<bool, 3> is_counted{};
    std::array<double, 3> mended_length{};  ///< metres, of the path if there were one
    /// Per kind and band, the phase counted from the emission.
    std::array<std::vector<std::complex<double>>, 3> pressure;
    audio::Spectrum upright{}, inverted{};  ///< absolute values of the sums by sign
};

/// The lowest triangle of some facets at a point of an edge or facet; of the first facet if none is
/// there. Precondition: there is a facet.
geometry::TriangleId triangle_at(const frustum::SceneView& scene,
                                 const geometry::Vec3& point,
                                 std::span<const geometry::FacetId> facets);

/// Nothing if every band is certain to be fainter than `min_pressure`.
std::optional<DiffractedSound> diffracted_sound(frustum::EdgePath way,
                                                const frustum::SceneView& scene,
                                                std::span<const geometry::Wedge> wedges,
                                                const SpecularPaths& specular,
                                                const DiffractionModel& model,
                                                double min_pressure = 0.0);

/// Multiplies the values of bands, which may be fewer than those of `sent`, by it.
template <typename Values>
void multiply(Values& values, const audio::Spectrum& sent) {
    for (std::size_t band = 0; band < values.size(); ++band) {
        values[band] *= sent[band];
    }
}

/// Multiplies everything by what the source sends towards the edge.
void radiate(const audio::Spectrum& sent, DiffractedSound& sound);

/// The path of a sound, but for its materials and with the triangles of the scene view: its
/// shortest way over the part of the edge.
Path describe(const DiffractedSound& sound,
              const frustum::SceneView& scene,
              std::span<const geometry::Wedge> wedges,
              const geometry::Vec3& source,
              const geometry::Vec3& listener,
              const DiffractionModel& model);

/// Arrivals of the energies of a pair. Close to a zone boundary a specular path and the terms that
/// mend it are one sound, whose pressures add up; far from it they arrive apart, and so do their
/// energies. A term counts towards the path with the weight c = sin x / x, x half the band's width
/// times the difference of their phases per hertz (0 from x = pi on), which is what the product of
/// both pressures is worth on average over a band, and with 1 - c^2 of its energy for itself. So
/// the energies are continuous where a path begins or ends. Where there is no path its place is
/// kept.
std::vector<audio::Arrival> energy_arrivals(std::span<const Path> paths,
                                            const SpecularPaths& specular,
                                            std::span<const DiffractedSound> sounds,
                                            const DiffractionModel& model);

}  // namespace earshot::propagation
