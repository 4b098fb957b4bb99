// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/update_statistics.h"
#include "earshot/frustum/path_arrivals.h"
#include "earshot/frustum/paths.h"
#include "earshot/frustum/scene_view.h"
#include "earshot/frustum/surface_points.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>

namespace earshot::frustum {

/// Per facet: 1 if it may be the first that reflects a path; empty: all may. For what is known of
/// where a source is; paths that another facet reflects first are left out.
using FirstFacets = std::span<const std::uint8_t>;

/// The beam tree of one source (Funkhouser 1998): its frusta and the facets visible in each, kept
/// so that listeners may move. Made by a PathFinder and valid as long as it is.
class SourceBeamTree {
public:
    SourceBeamTree(SourceBeamTree&&) noexcept;
    SourceBeamTree& operator=(SourceBeamTree&&) noexcept;
    ~SourceBeamTree();

    const geometry::Vec3& source() const noexcept;
    std::size_t frusta() const noexcept;       ///< in all
    std::size_t kept_frusta() const noexcept;  ///< of these: not traced again by the last update
    std::size_t bytes() const noexcept;        ///< of memory, about

private:
    friend class PathFinder;
    struct Kept;
    explicit SourceBeamTree(std::unique_ptr<Kept> kept);
    std::unique_ptr<Kept> kept_;
};

/// The beam trees of some listeners, one or two reflections deep, kept so that sources may move.
/// Made by a PathFinder and valid as long as it is.
class ListenerBeamTree {
public:
    ListenerBeamTree(ListenerBeamTree&&) noexcept;
    ListenerBeamTree& operator=(ListenerBeamTree&&) noexcept;
    ~ListenerBeamTree();

    std::span<const geometry::Vec3> listeners() const noexcept;
    std::size_t frusta() const noexcept;       ///< in all
    std::size_t kept_frusta() const noexcept;  ///< of these: not traced again by the last update
    std::size_t bytes() const noexcept;        ///< of memory, about

private:
    friend class PathFinder;
    struct Kept;
    explicit ListenerBeamTree(std::unique_ptr<Kept> kept);
    std::unique_ptr<Kept> kept_;
};

/// With which subpaths of listeners the facets visible to one source have been connected, and what
/// the verification of its candidate sequences came to, kept so that what nothing that has moved
/// concerns need not be looked for or verified at the next instant. Used with one PathFinder.
class KeptVerdicts {
public:
    KeptVerdicts();
    KeptVerdicts(KeptVerdicts&&) noexcept;
    KeptVerdicts& operator=(KeptVerdicts&&) noexcept;
    ~KeptVerdicts();

    std::size_t size() const noexcept;              ///< sequences
    std::size_t connections() const noexcept;       ///< of visible facets with subpaths
    std::size_t kept_connections() const noexcept;  ///< of these: not looked for again
    std::size_t bytes() const noexcept;             ///< of memory, about

private:
    friend class PathFinder;
    struct Kept;
    std::unique_ptr<Kept> kept_;
};

/// For estimates of time: of the frusta that have been reflected `order` times only a random share
/// is followed, so that paths are missing. The same share for any executor.
struct BeamSample {
    int order = 1;       ///< >= 1
    double share = 1.0;  ///< 0 ... 1; 1: all
};

struct FinderOptions {
    TraceOptions trace{};
    BeamSample sample{};
    /// Trace the source's beam tree to the last reflection, instead of connecting a smaller one
    /// with beam trees from the listeners (bidirectional tracing). Costs more per source, and less
    /// per listener: for listeners by the thousand. Changes the time only; Mode::sampled always
    /// traces forward only.
    bool forward_only = false;
    /// Largest distance of a source or listener from the origin, metres; 0: sixteen times the
    /// scene's largest coordinate. Changes the time only.
    double max_radius = 0.0;
    /// How many listeners are connected with each source, about: the more, the larger the source's
    /// part of bidirectional tracing. Changes the time only.
    std::size_t listener_count = 1;
    /// Keep a copy of the geometry, which tells move_to() what has changed, so that update() does
    /// not trace everything anew. Changes time and memory only.
    bool track_changes = false;
};

/// Whether forward-only tracing is the faster way to so many listeners.
bool prefer_forward(std::size_t listener_count, int max_order) noexcept;

/// Finds specular paths in one scene at one instant for sources and listeners that move: the beam
/// tree of a point is traced once and kept while the point stays. The paths are those of a fresh
/// search, to the last bit. Every member may be called from several threads.
class PathFinder {
public:
    /// What the view refers to must outlive the finder. Throws Error if an option is out of range.
    explicit PathFinder(const SceneView& scene,
                        const FinderOptions& options = {},
                        Executor& executor = Executor::serial());
    PathFinder(PathFinder&&) noexcept;
    PathFinder& operator=(PathFinder&&) noexcept;
    ~PathFinder();

    /// Moves to the scene at another instant, for about `queries` frusta. As a new finder, but the
    /// hierarchy over the facets follows them while they are made of the same triangles. Beam trees
    /// made before are no longer valid until update().
    void move_to(const SceneView& scene,
                 const FinderOptions& options,
                 double queries,
                 Executor& executor = Executor::serial());
    /// How many hierarchies over facets there have been, and how they followed the facets.
    std::uint64_t hierarchies_built() const noexcept;
    const bvh::UpdateStatistics& updates() const noexcept;

    /// Reports the stage "tracing". Precondition, here and below: points lie within max_radius() of
    /// the origin.
    SourceBeamTree trace_source(const geometry::Vec3& source,
                                FirstFacets first = {},
                                Executor& executor = Executor::serial(),
                                Progress* progress = nullptr) const;
    ListenerBeamTree trace_listeners(std::span<const geometry::Vec3> listeners,
                                     Executor& executor = Executor::serial()) const;

    /// Make a beam tree valid again that was so before the last move_to(), or any that this finder
    /// has made. With FinderOptions::track_changes only the frusta are traced again that meet what
    /// has moved or that have become others, if the options are the same as before, the mode is
    /// complete, the scene's tolerances and triangles are the same and nothing is known of the
    /// first facets; else all are. Reports the stage "tracing".
    void update(SourceBeamTree& source,
                FirstFacets first = {},
                Executor& executor = Executor::serial(),
                Progress* progress = nullptr) const;
    void update(ListenerBeamTree& listeners, Executor& executor = Executor::serial()) const;
    /// Whether a beam tree was made or updated since the last move_to().
    bool is_current(const SourceBeamTree& source) const noexcept;
    bool is_current(const ListenerBeamTree& listeners) const noexcept;

    /// Every path from the source to each listener. Points are taken as they are: on a surface they
    /// receive nothing through it, and less than half of the paths (see place_pairs).
    TraceResult connect(const SourceBeamTree& source,
                        const ListenerBeamTree& listeners,
                        Executor& executor = Executor::serial()) const;

    /// The same, where only sequences are verified on which `verdicts` has none that still holds:
    /// of the same source and listeners, before the last move_to() or since. If they are of the
    /// same beam trees, or of those from which update() has made both, connections are only looked
    /// for where at least one end is another. Then holds the verdicts and connections of now.
    TraceResult connect(const SourceBeamTree& source,
                        const ListenerBeamTree& listeners,
                        KeptVerdicts& verdicts,
                        Executor& executor = Executor::serial()) const;

    /// The same without keeping the source's beam tree: memory does not grow with the number of
    /// frusta. The statistics leave out the listeners' frusta, here and above. Reports the stage
    /// "tracing".
    TraceResult find(const geometry::Vec3& source,
                     const ListenerBeamTree& listeners,
                     FirstFacets first = {},
                     Executor& executor = Executor::serial(),
                     Progress* progress = nullptr) const;

    /// Every path of pairs of which some points lie on surfaces, sorted by the listeners' numbers.
    /// Precondition: no point is undecided. The statistics include the listeners' frusta.
    TraceResult find(const PlacedPairs& pairs,
                     FirstFacets first = {},
                     Executor& executor = Executor::serial()) const;

    using VisitPaths = std::function<void(std::size_t, std::span<const SpecularPath>)>;

    /// Calls visit(listener, its paths) for each of any number of listeners, in their order, from
    /// this thread. Memory holds the paths of some thousand listeners at a time.
    void for_each_listener(const SourceBeamTree& source,
                           std::span<const geometry::Vec3> listeners,
                           const VisitPaths& visit,
                           Executor& executor = Executor::serial()) const;

    /// Largest distance of a source or listener from the origin, metres.
    double max_radius() const noexcept;

    /// The paths of one pair without their points, where the scene is a box whose walls are
    /// coordinate planes and the lattice of its images gives the paths; else nothing. Valid as long
    /// as the finder.
    std::optional<PathArrivals> find_arrivals(const geometry::Vec3& source,
                                              const geometry::Vec3& listener) const;

    /// Whether the scene is a box whose image lattice gives the paths between points inside.
    bool is_box() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::frustum
