// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/trace.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>

namespace earshot::frustum {

/// Per facet: 1 if it may be the first that reflects a path; empty: all may. For what is known of
/// where a source is; paths that another facet reflects first are left out.
using FirstFacets = std::span<const std::uint8_t>;

/// What the frusta from one source see, kept so that listeners may move. Made by a PathFinder and
/// valid as long as it is.
class SourceTrace {
public:
    SourceTrace(SourceTrace&&) noexcept;
    SourceTrace& operator=(SourceTrace&&) noexcept;
    ~SourceTrace();

    const geometry::Vec3& source() const noexcept;
    std::size_t frusta() const noexcept;  ///< that were traced
    std::size_t bytes() const noexcept;   ///< of memory, about

private:
    friend class PathFinder;
    struct Kept;
    explicit SourceTrace(std::unique_ptr<Kept> kept);
    std::unique_ptr<Kept> kept_;
};

/// What the frusta from some listeners see, kept so that sources may move. Made by a PathFinder and
/// valid as long as it is.
class ListenerTrace {
public:
    ListenerTrace(ListenerTrace&&) noexcept;
    ListenerTrace& operator=(ListenerTrace&&) noexcept;
    ~ListenerTrace();

    std::span<const geometry::Vec3> listeners() const noexcept;
    std::size_t frusta() const noexcept;  ///< that were traced

private:
    friend class PathFinder;
    struct Kept;
    explicit ListenerTrace(std::unique_ptr<Kept> kept);
    std::unique_ptr<Kept> kept_;
};

struct FinderOptions {
    TraceOptions trace{};
    /// Follow the source's frusta to the last reflection, instead of meeting frusta from the
    /// listeners one reflection before it. Costs more per source, and much less per listener: for
    /// listeners by the hundred, or that move. Changes the time only; Mode::sampled always does.
    bool all_the_way = false;
    /// No source or listener will lie farther from the origin, metres; 0: sixteen times as far as
    /// the scene's largest coordinate. Changes the time only.
    double reach = 0.0;
};

/// Whether so many listeners are better found by following the source's frusta all the way.
bool are_many(std::size_t listeners, int max_order) noexcept;

/// find_specular_paths() for one scene at one instant and sources and listeners that move: what a
/// point's frusta see is traced once and kept while the point stays. The paths are those of a fresh
/// search, to the last bit. Every member may be called from several threads.
class PathFinder {
public:
    /// The surroundings must outlive it. Throws Error if an option is out of range.
    explicit PathFinder(const Surroundings& surroundings, const FinderOptions& options = {});
    PathFinder(PathFinder&&) noexcept;
    PathFinder& operator=(PathFinder&&) noexcept;
    ~PathFinder();

    /// Precondition, here and below: points keep within the reach.
    SourceTrace trace_source(const geometry::Vec3& source,
                             Executor& executor = Executor::serial(),
                             FirstFacets first = {}) const;
    ListenerTrace trace_listeners(std::span<const geometry::Vec3> listeners,
                                  Executor& executor = Executor::serial()) const;

    /// Every path from the source to each listener.
    TraceResult connect(const SourceTrace& source,
                        const ListenerTrace& listeners,
                        Executor& executor = Executor::serial()) const;

    /// The same without keeping the source's part: memory does not grow with the number of frusta.
    /// The statistics leave out the listeners' frusta, here and above.
    TraceResult find(const geometry::Vec3& source,
                     const ListenerTrace& listeners,
                     Executor& executor = Executor::serial(),
                     FirstFacets first = {}) const;

    using VisitPaths = std::function<void(std::size_t, std::span<const SpecularPath>)>;

    /// Calls visit(listener, its paths) for each of any number of listeners, in their order, from
    /// this thread. Memory holds the paths of some thousand listeners at a time.
    void for_each_listener(const SourceTrace& source,
                           std::span<const geometry::Vec3> listeners,
                           const VisitPaths& visit,
                           Executor& executor = Executor::serial()) const;

    /// No point may lie farther from the origin, metres.
    double reach() const noexcept;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot::frustum
