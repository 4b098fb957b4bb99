// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/error.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/update_statistics.h"
#include "earshot/frustum/paths.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/geometry/clean.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/late_energy.h"
#include "earshot/propagation/pair_result.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/visible_sets.h"

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <vector>

namespace earshot::propagation {

/// Of Options::diffraction.
inline constexpr int kMaxDiffraction = 2;

struct Options {
    int specular_order = 4;  ///< max reflections and transmissions of a path, >= 0
    /// How many edges sound bends round on its way at most, 0 to kMaxDiffraction: one, beside up to
    /// specular_order reflections, or two in turn without any. A specular path and what edges make
    /// of it are found together (see docs/algorithms/diffraction.md). Late sound knows no edges.
    int diffraction = 0;
    /// Diffracted paths are left out whose loudest band is fainter, in decibels re the source's
    /// free field at the listener's distance, or at 1 m if it is closer. -inf: none are.
    double min_diffraction_level_db = -40.0;
    frustum::Mode mode = frustum::Mode::complete;
    int resolution = 0;  ///< sub-frusta along a frustum's side; 0: the mode's default
    /// Off: PairResult::arrivals in place of paths, for responses that nobody asks the paths of. In
    /// boxes between omnidirectional sources and listeners these come in less time and memory.
    bool report_paths = true;
    /// Answer rooms that are boxes by their image lattice; changes the time only.
    bool box_lattice = true;
    Air air{};
    bool air_absorption = true;
    bool transmission = false;  ///< sound also goes through materials that transmit
    /// Longer paths are left out, metres.
    double max_length = std::numeric_limits<double>::infinity();
    /// Paths are left out whose loudest band is fainter, in decibels re the source's free field at
    /// 1 m in front.
    double min_level_db = -std::numeric_limits<double>::infinity();
    /// For late sound; 0: none. See RayOptions.
    std::size_t rays = 0;
    double max_error = 0.0;  ///< relative, of T30; 0: all rays. See RayOptions
    std::uint64_t seed = 1;
    /// See RayOptions.
    double rain_radius = std::numeric_limits<double>::infinity();
    bool weight_window = false;  ///< likewise
    double late_length = 0.0;    ///< seconds; 0: as long as the decay, see propagation::late_length
    bool late_directions = false;  ///< tell where late sound comes from
    /// Tell which materials late sound has met (PairResult::late_materials), for
    /// pair_sensitivity(). Costs time and memory and changes no other result.
    bool report_materials = false;
    /// Tell besides how often these scattered it (LateMaterials::Part::scatterings); needs
    /// report_materials. Likewise.
    bool report_scattering = false;
    /// Keep beam trees, and what became of the sequences of facets that were verified, from run to
    /// run: for sources and listeners that move, and for geometry of which parts move. Only what
    /// meets that which has moved is traced and verified again. Costs memory, some MiB per source
    /// and listener at order 3 in a scene of thousands of facets and ten to twenty times as much
    /// per further order (docs/algorithms/frustum.md, "Geometry that moves"), and changes no
    /// result.
    bool keep_traces = false;
    /// Paths are left out that are first reflected by a facet of which the cell of their source
    /// sees no triangle; of a source outside of the region none are. Must outlive the simulator.
    /// Sets may lack what can be seen (VisibleSets), and know nothing of what is heard through
    /// facets (transmission): then paths are missing.
    const visibility::VisibleSets* visible_sets = nullptr;
    audio::Bands bands = audio::Bands::octaves();
};

/// What the scene amounts to at the current time.
struct GeometrySummary {
    geometry::CleanReport clean;
    std::size_t triangles = 0;  ///< that take part
    std::size_t facets = 0;
};

/// How the hierarchies of a scene came about and followed its geometry.
struct HierarchyStatistics {
    std::uint64_t triangle_builds = 0, facet_builds = 0;  ///< without rebuilds
    bvh::UpdateStatistics updates{};
};

/// Simulates sound between the sources and listeners of one scene, which must outlive it.
class Simulator {
public:
    /// Prepares the scene at time 0. Throws Error if an option is out of range, a material
    /// transmits more than it absorbs, or no triangle is left after clean-up.
    explicit Simulator(const Scene& scene,
                       const Options& options = {},
                       Executor& executor = Executor::serial());
    ~Simulator();
    Simulator(Simulator&&) noexcept;
    Simulator& operator=(Simulator&&) noexcept;

    /// Moves the geometry, sources and listeners to `time` (seconds). Results never depend on the
    /// times visited before. Throws Error if no triangle with an area is left then; the time before
    /// stays.
    void set_time(double time, Executor& executor = Executor::serial());

    /// Every pair, ordered by source, then listener. A pair at the same point has no direct path
    /// (its amplitude would be infinite). A point on a surface is taken as the limit from the side
    /// on which the pair's other point lies; the ends of its paths are the point itself. Throws
    /// Error where that does not tell (both in one plane, or at the edge of a free sheet), and if
    /// Options::visible_sets are of another mesh or of another pose. Reports the stages "tracing"
    /// and "late rays".
    std::vector<PairResult> run(Executor& executor = Executor::serial(),
                                Progress* progress = nullptr);

    /// Takes a pair.
    using VisitPair = std::function<void(PairResult&&)>;
    /// The same pairs for listeners by the hundred: calls visit() once for each, from several
    /// threads at a time and in any order, so that memory holds the late sound of few of them.
    void for_each_pair(const VisitPair& visit,
                       Executor& executor = Executor::serial(),
                       Progress* progress = nullptr);

    /// From now on results are only of pairs with these sources, in ascending order, for programs
    /// that refresh some sources at a time; all others keep their traces. Changes no result.
    /// Precondition: the sources exist.
    void select_sources(std::vector<std::size_t> sources);

    /// Takes time like clean-up.
    GeometrySummary geometry(Executor& executor = Executor::serial()) const;
    /// What is odd about the scene at the current time: places that two materials claim. Takes time
    /// like clean-up.
    Warnings warnings(Executor& executor = Executor::serial()) const;
    /// The scene as the tracer sees it; valid until the time is set or the simulator destroyed.
    frustum::SceneView scene_view(Executor& executor = Executor::serial()) const;
    /// Of each triangle of the scene in file order: its facet in scene_view(), kNoFacet if it takes
    /// no part.
    std::vector<geometry::FacetId> facet_of_triangle(Executor& executor = Executor::serial()) const;
    static constexpr geometry::FacetId kNoFacet = std::numeric_limits<geometry::FacetId>::max();
    /// The scene as rays see it; valid as long.
    RayScene ray_scene() const noexcept;
    /// The hierarchies over the triangles and over their facets since the simulator was made.
    HierarchyStatistics hierarchy_statistics() const noexcept;
    /// Of the last run, summed over sources: what it traced and verified, and what it kept.
    const frustum::TraceStatistics& statistics() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::propagation
