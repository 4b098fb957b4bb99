// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/math.h"
#include "earshot/frustum/path_finder.h"
#include "earshot/propagation/internal/coincident_materials.h"
#include "earshot/propagation/internal/diffracted_paths.h"
#include "earshot/propagation/internal/first_facets.h"
#include "earshot/propagation/internal/radiated_sound.h"
#include "earshot/propagation/internal/scene_geometry.h"
#include "earshot/propagation/simulator.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::propagation {

/// What a simulator keeps from run to run.
struct Simulator::State {
    State(const Scene& the_scene, const Options& the_options)
        : scene(the_scene),
          options(the_options),
          speed_of_sound(propagation::speed_of_sound(the_options.air)),
          min_pressure(math::pow10(the_options.min_level_db / 20.0)),
          air(the_options.air, the_options.bands),
          geometry(the_scene,
                   facet_materials(the_scene, the_options.bands, the_options.transmission)) {
        for (const Material& material : scene.materials) {
            reflection.push_back(reflected_pressure(material, options.bands));
            transmission.push_back(transmitted_pressure(material, options.bands));
        }
        for (std::size_t source = 0; source < scene.sources.size(); ++source) {
            selected.push_back(source);
        }
    }

    const Scene& scene;
    Options options;
    double speed_of_sound = 0.0;
    double min_pressure = 0.0;
    AirAbsorption air;
    std::vector<audio::Spectrum> reflection;    // pressure factor per material
    std::vector<audio::Spectrum> transmission;  // likewise

    /// With Options::keep_traces: of one source.
    struct KeptSource {
        std::optional<frustum::SourceBeamTree> beams;
        frustum::KeptVerdicts verdicts{};
        bool is_too_large = false;  // for kMaxKeptBytes: no longer kept
    };
    /// Of the beam trees of all sources.
    static constexpr std::size_t kMaxKeptBytes = std::size_t{1} << 30;

    std::vector<std::size_t> selected;  // sources of a run, ascending

    double time = 0.0;
    SceneGeometry geometry;
    std::uint64_t queries = 0;  // of the last run, about
    bool needs_facets = true;   // of the last run
    frustum::TraceStatistics statistics;

    // Of the geometry as it is.
    std::optional<frustum::PathFinder> finder;
    bool finder_is_current = false;
    std::vector<KeptSource> sources;
    std::optional<frustum::ListenerBeamTree> listeners;
    std::optional<DiffractedPaths> diffracted;

    void prepare_finder(std::span<const geometry::Vec3> from,
                        std::span<const geometry::Vec3> to,
                        std::uint64_t frusta,
                        Executor& executor);
    void prepare_listeners(std::span<const geometry::Vec3> to, Executor& executor);
    std::vector<std::uint8_t> first_facets(const geometry::Vec3& source, Executor& executor) const {
        return propagation::first_facets(options.visible_sets, geometry, source, executor);
    }
    frustum::PlacedPairs place(const Emitter& source,
                               const geometry::Vec3& position,
                               std::span<const geometry::Vec3> to,
                               Executor& executor) const;
    frustum::TraceResult trace_kept(KeptSource& kept,
                                    const geometry::Vec3& position,
                                    std::span<const std::uint8_t> first,
                                    Executor& executor,
                                    Progress* progress);
    frustum::TraceResult trace(std::size_t source,
                               const geometry::Vec3& position,
                               const frustum::PlacedPairs& placed,
                               Executor& executor,
                               Progress* progress);

    void move_geometry(double to, Executor& executor);
    void check_visible_sets() const;
    bool requires_facets(std::span<const geometry::Vec3> from,
                         std::span<const geometry::Vec3> to) const;
    frustum::TraceOptions trace_options() const;
    void add_paths(std::size_t source,
                   const RaySource& sender,
                   const frustum::PlacedPairs& placed,
                   std::span<PairResult> pairs,
                   Executor& executor,
                   Progress* progress);
    void add_late_sound(const RaySource& sender,
                        const frustum::PlacedPairs& placed,
                        std::span<PairResult> pairs,
                        const VisitPair& visit,
                        Executor& executor,
                        Progress* progress);
    void add_diffracted_paths(const RaySource& sender,
                              const frustum::PlacedPairs& placed,
                              std::span<PairResult> pairs,
                              Executor& executor);
    RayOptions ray_options(const RaySource& source, Executor& executor) const;
    bool is_wanted(const Path& path) const;
    Path describe(const frustum::SpecularPath& specular, const double* air_pressures) const;
    bool add_arrivals(const RaySource& sender,
                      const frustum::PlacedPairs& placed,
                      std::span<PairResult> pairs,
                      Executor& executor);
};

}  // namespace earshot::propagation
