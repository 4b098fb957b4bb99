// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/impulse_response.h"
#include "earshot/base/parallel.h"
#include "earshot/frustum/edge_pair_paths.h"
#include "earshot/frustum/edge_paths.h"
#include "earshot/frustum/surface_points.h"
#include "earshot/geometry/wedge.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/internal/diffracted_sound.h"
#include "earshot/propagation/internal/doubly_diffracted_sound.h"
#include "earshot/propagation/internal/scene_geometry.h"
#include "earshot/propagation/late_rays.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"

#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// What diffracted paths need of a simulation beside its geometry.
struct DiffractionSettings {
    const audio::Bands& bands;
    const AirAbsorption& air;
    std::span<const audio::Spectrum> reflection;  ///< pressure factor per material
    double speed_of_sound = 0.0;
    bool air_absorption = true;
    int max_order = 0;         ///< of specular paths, and of reflections beside an edge
    int max_edges = 1;         ///< of a path, 1 or 2
    bool keep_traces = false;  ///< see frustum::EdgePathOptions
    double max_length = 0.0;
    double min_pressure = 0.0;  ///< of the loudest band of a path
    /// The loudest band of a path is at least this times the source's free field at the listener's
    /// distance, or at 1 m if it is closer.
    double min_pressure_ratio = 0.0;
};

/// The diffracted paths of a scene at one instant.
class DiffractedPaths {
public:
    /// Everything must outlive it, and the geometry stay in its pose.
    DiffractedPaths(const Scene& scene,
                    const SceneGeometry& geometry,
                    const DiffractionSettings& settings,
                    Executor& executor);

    /// Adds paths, and the arrivals of energies, to the pairs of a source, which have their
    /// specular paths. `listeners`: where they were asked for.
    void add(const RaySource& source,
             const frustum::PlacedPairs& placed,
             std::span<const geometry::Vec3> listeners,
             std::span<PairResult> pairs,
             Executor& executor);

    /// With DiffractionSettings::keep_traces: discards what is kept of points that no call of add()
    /// has named since the last discard_unused().
    void discard_unused() { finder_.discard_unused(); }

private:
    struct SoundOverTwo {
        DoublyDiffractedSound sound;
        Path path;
    };

    SpecularPaths specular_paths(const PairResult& pair) const;
    /// Of the loudest band of paths from a source to a listener.
    double min_pressure(const geometry::Vec3& source, const geometry::Vec3& listener) const;
    void add_to_pair(const RaySource& source,
                     const geometry::Vec3& from,
                     const geometry::Vec3& to,
                     double min_pressure,
                     std::span<frustum::EdgePath> ways,
                     std::span<SoundOverTwo> over_two,
                     PairResult& pair) const;
    /// Sounds over one edge and what they mend, and paths.
    struct PairSounds {
        std::vector<DiffractedSound> sounds;
        std::vector<Path> paths;
        std::vector<audio::Arrival> arrivals;  ///< of energies, beside those of the sounds
    };
    DiffractionModel model() const;
    /// Nothing if it is longer or fainter than asked for.
    std::optional<SoundOverTwo> sound_over_two_edges(const RaySource& source,
                                                     const geometry::Vec3& from,
                                                     const geometry::Vec3& to,
                                                     double min_pressure,
                                                     const frustum::EdgePairPath& way) const;
    /// Per listener of a group, in the order of find_edge_pair_paths(). Empty if paths over two
    /// edges are not asked for.
    std::vector<std::vector<SoundOverTwo>> sounds_over_two_edges(
        const RaySource& source,
        const frustum::PlacedListeners& group,
        std::span<const geometry::Vec3> listeners,
        Executor& executor) const;
    void name_materials(Path& path) const;

    const Scene& scene_;
    const SceneGeometry& geometry_;
    DiffractionSettings settings_;
    frustum::SceneView view_;
    std::span<const geometry::Wedge> wedges_;
    std::vector<geometry::FacetId> facet_of_triangle_;  // by the numbers of the scene
    std::vector<audio::Spectrum> reflection_of_facet_;
    std::vector<double> max_reflection_of_facet_;
    frustum::EdgePathFinder finder_;
};

}  // namespace earshot::propagation
