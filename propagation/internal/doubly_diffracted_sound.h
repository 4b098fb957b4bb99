// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/audio/impulse_response.h"
#include "earshot/frustum/edge_pair_paths.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/interval.h"
#include "earshot/geometry/wedge.h"
#include "earshot/propagation/internal/diffracted_sound.h"
#include "earshot/propagation/pair_result.h"

#include <array>
#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// The sound of one way over two edges. Per kind of term at each edge, which mends the first-order
/// path over the other edge with the same reflections in faces.
struct DoublyDiffractedSound {
    frustum::EdgePairPath way;
    /// Where the shortest way meets the edges, and the parts of them that take part.
    std::array<geometry::Vec3, 2> apexes{};
    std::array<geometry::Interval, 2> parts{};
    double length = 0.0;  ///< of the shortest way, metres
    /// By kind at the first edge, kind at the second and band; the phase is counted from the
    /// emission. Kinds that are not counted are 0.
    std::array<std::array<std::vector<std::complex<double>>, 3>, 3> pressure;
    audio::Spectrum upright{}, inverted{};  ///< absolute values of the sums by sign
};

/// Tells which ways over two edges may be as loud and as short as is asked for, before it is known
/// which parts of the edges see each other.
class EdgePairLevelFilter final : public frustum::EdgePairFilter {
public:
    EdgePairLevelFilter(const geometry::Vec3& source,
                        std::span<const geometry::Vec3> listeners,
                        double max_length,
                        const DiffractionModel& model)
        : source_(source), listeners_(listeners), max_length_(max_length), model_(model) {}

    /// The next listener, and the pressure in the loudest band that is asked for there of a source
    /// that sends 1.
    void add_listener(double min_pressure) { min_pressure_.push_back(min_pressure); }

    bool may_be_wanted(const geometry::Wedge& first,
                       const geometry::Interval& of_first,
                       const geometry::Wedge& second,
                       const geometry::Interval& of_second,
                       const std::optional<std::array<int, 2>>& common_face,
                       std::size_t listener) const override;

private:
    geometry::Vec3 source_;
    std::span<const geometry::Vec3> listeners_;
    double max_length_;
    DiffractionModel model_;
    std::vector<double> min_pressure_;  // per listener
};

/// Nothing if the way is longer than `max_length`, or if every band is certain to be fainter than
/// `min_pressure`.
std::optional<DoublyDiffractedSound> doubly_diffracted_sound(
    const frustum::EdgePairPath& way,
    std::span<const geometry::Wedge> wedges,
    const geometry::Vec3& source,
    const geometry::Vec3& listener,
    const DiffractionModel& model,
    double max_length,
    double min_pressure);

/// Multiplies everything by what the source sends towards the first edge.
void radiate(const audio::Spectrum& sent, DoublyDiffractedSound& sound);

/// The path of a sound, but for its materials and with the triangles of the scene view.
Path describe(const DoublyDiffractedSound& sound,
              const frustum::SceneView& scene,
              std::span<const geometry::Wedge> wedges,
              const geometry::Vec3& source,
              const geometry::Vec3& listener,
              const DiffractionModel& model);

/// Adds sounds over two edges to those over one that they mend, as far as they arrive as one with
/// them: where a path over one edge is cut by the other, both are one sound. Where there is no path
/// over one edge its place is added, without pressure. Returns the arrivals of what is left.
std::vector<audio::Arrival> join_mended_sounds(std::span<const DoublyDiffractedSound> sounds,
                                               const frustum::SceneView& scene,
                                               std::span<const geometry::Wedge> wedges,
                                               const geometry::Vec3& source,
                                               const geometry::Vec3& listener,
                                               const SpecularPaths& specular,
                                               const DiffractionModel& model,
                                               std::vector<DiffractedSound>& first_order);

}  // namespace earshot::propagation
