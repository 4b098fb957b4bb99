// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/frustum/internal/facet_index.h"
#include "earshot/frustum/internal/frustum.h"
#include "earshot/frustum/internal/kept_connections.h"
#include "earshot/frustum/internal/points_by_facet.h"
#include "earshot/frustum/internal/subpath_tree.h"
#include "earshot/frustum/internal/visible_facets.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::frustum {

class GeometryChange;

/// A facet that may be the last reflection on the path to a listener. It is stored under that facet
/// with the listener mirrored in it as its point.
struct LastReflection {
    std::uint32_t listener = 0;
};

/// The last one or two reflections on a path to a listener, as its beam tree has them: `first` is
/// visible in a frustum that starts at the listener or, of two, was mirrored in `last`. (A subpath
/// in the sense of bidirectional path tracing, Veach and Guibas 1994.)
struct ListenerSubpath {
    VisibleFacet first;
    geometry::FacetId last = 0;  ///< of one reflection: `first`
    std::uint32_t listener = 0;
    std::uint32_t frustum = 0;  ///< in which `first` is visible
    bool has_two = false;
};

/// The beam trees of some listeners for bidirectional tracing. Sound paths are reversible, so the
/// facets visible from a listener, and those visible in its mirrored frusta, are the only ones in
/// which paths to it can end (complete mode):
///
///     source --> f1 --> ... --> f(n-m) ----------------> f(n-m+1) <-- ... f(n) <-- listener
///     |   beam tree of the source    |  connecting leg  |        subpath          |
///
/// The connecting leg belongs to neither tree: it is a straight line from an image source to an
/// image of the listener that passes the apertures at both of its ends. What stands in between is
/// left to the verification.
class ListenerBeams {
public:
    /// `max_radius`: the largest distance of a source or listener from the origin, metres.
    /// `max_order`: of paths. `subpath_reflections`: 0, 1 or 2 reflections of subpaths are wanted.
    ListenerBeams(const FacetIndex& index,
                  double contact_radius,
                  double max_radius,
                  int max_order,
                  std::span<const geometry::Vec3> listeners,
                  int subpath_reflections,
                  Executor& executor);

    /// The same, where only frusta are traced that swept boxes meet or that `before` lacks, the
    /// beam trees before a change. Preconditions: the change is not total; `before` has the same
    /// listeners and was made with the same numbers.
    ListenerBeams(const FacetIndex& index,
                  double contact_radius,
                  double max_radius,
                  int max_order,
                  std::span<const geometry::Vec3> listeners,
                  int subpath_reflections,
                  const ListenerBeams& before,
                  const GeometryChange& change,
                  Executor& executor);

    /// The facets visible from the listeners.
    const PointsByFacet<LastReflection>& last_reflections() const noexcept {
        return last_reflections_;
    }

    /// All subpaths, of one reflection and of two.
    std::span<const ListenerSubpath> subpaths() const noexcept { return subpaths_; }
    /// The listener of a subpath, mirrored in its reflections from the last to the first.
    const geometry::Vec3& image(std::uint32_t subpath) const noexcept { return images_[subpath]; }
    /// The subpaths by where legs to them run.
    const SubpathTree& tree() const noexcept { return tree_; }
    /// After a change: those that there were not before; find_new() looks for legs to them.
    void find_new(const ConnectingLegs& legs, std::vector<std::uint32_t>& found) const;
    bool has_new() const noexcept { return !new_.empty(); }
    /// After a change: the number of a subpath that there was, or kNotBefore if it is no more.
    std::uint32_t number_now(std::uint32_t before) const noexcept { return number_now_[before]; }
    double max_coordinate() const noexcept { return tree_.max_coordinate(); }

    /// Whether sound from an image source that is mirrored in all facets before the subpath may
    /// travel on straight to `first`, and from there to the listener. `folded`: the image source
    /// mirrored in `first`.
    bool may_arrive_from(const ListenerSubpath& subpath,
                         const geometry::Vec3& image_source,
                         const geometry::Vec3& folded) const noexcept;

    /// In all.
    std::size_t frusta() const noexcept { return frusta_.size(); }
    /// Of these, that were not traced again.
    std::size_t kept_frusta() const noexcept;
    /// Of memory, about.
    std::size_t bytes() const noexcept;

private:
    /// The beam trees before a change; null: there are none.
    struct Before {
        const ListenerBeams* beams = nullptr;
        const GeometryChange* change = nullptr;
    };
    struct VisiblePair {
        std::uint32_t listener = 0;
        geometry::FacetId facet = 0;
    };
    /// Some of what is visible in a frustum.
    struct Found {
        std::vector<ListenerSubpath> subpaths;
        std::vector<Frustum> reflected;
        std::vector<std::uint32_t> listeners;  ///< of the reflected frusta
    };

    void trace(std::span<const geometry::Vec3> listeners,
               double contact_radius,
               int max_order,
               int subpath_reflections,
               const Before& before,
               Executor& executor);
    void trace_first_beams(std::span<const geometry::Vec3> listeners,
                           double contact_radius,
                           int subpath_reflections,
                           const Before& before,
                           Executor& executor);
    void trace_reflected_beams(double contact_radius, const Before& before, Executor& executor);
    /// The facets that were visible in a frustum, by their numbers then.
    std::vector<VisibleFacet> visible_in(std::size_t frustum) const;
    const OccluderDepths& occluders_of(std::size_t reflected) const noexcept {
        return occluders_[reflected - (frusta_.size() - occluders_.size())];
    }
    bool find_visible(std::size_t frustum,
                      std::optional<std::size_t> old,
                      const Before& before,
                      VisibleFacets& search,
                      std::vector<VisibleFacet>& visible,
                      OccluderDepths& occluders) const;
    void append_last_reflections(std::span<const geometry::Vec3> listeners,
                                 const std::vector<Found>& found);
    void append_before_grazing(const geometry::Vec3& listener,
                               const ListenerSubpath& grazing,
                               int max_order);
    void place_images(std::span<const geometry::Vec3> listeners,
                      const Before& before,
                      Executor& executor);
    std::vector<std::uint32_t> subpaths_before(const Before& before) const;
    void plant_trees(std::span<const std::uint32_t> number_before,
                     const ListenerBeams* before,
                     Executor& executor);
    geometry::Aabb aperture_box(const ListenerSubpath& subpath) const;

    const FacetIndex& index_;
    double max_radius_;
    std::vector<Frustum> frusta_;  // six around each listener, then the reflected ones
    std::vector<std::uint32_t> listener_of_reflected_;
    std::vector<std::uint32_t> first_subpath_;  // per frustum, and one past the last
    std::vector<OccluderDepths> occluders_;     // per reflected frustum
    std::vector<std::uint32_t> before_;  // per frustum: its number before a change, or kNotBefore
    std::vector<std::uint8_t> is_kept_;  // likewise: 1 if it was not searched again
    PointsByFacet<LastReflection> last_reflections_;
    std::vector<ListenerSubpath> subpaths_;
    std::vector<geometry::Vec3> images_;
    std::vector<SubpathBounds> bounds_;
    SubpathTree tree_;
    std::vector<std::uint32_t> number_now_;  // per subpath before a change
    std::vector<std::uint32_t> new_;         // subpaths that there were not before a change
    SubpathTree tree_of_new_;                // over them, by their places in new_
};

}  // namespace earshot::frustum
