// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/edge_sides.h"

#include <algorithm>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;
using geometry::Wedge;

namespace {

/// Per facet the wedges that it is a face of.
std::vector<std::vector<std::uint32_t>> wedges_by_facet(std::span<const Wedge> wedges,
                                                        std::size_t facets) {
    std::vector<std::vector<std::uint32_t>> of_facet(facets);
    for (std::size_t i = 0; i < wedges.size(); ++i) {
        for (const geometry::WedgeFace& face : wedges[i].faces) {
            std::vector<std::uint32_t>& list = of_facet[face.facet];
            if (list.empty() || list.back() != i) {
                list.push_back(static_cast<std::uint32_t>(i));
            }
        }
    }
    return of_facet;
}

/// A task of BeamTracer::trace that collects the wedges of the facets that are visible, as far as
/// sound in the frustum may arrive at them.
class EdgeCollector {
public:
    EdgeCollector(const std::vector<std::vector<std::uint32_t>>& of_facet,
                  std::span<const Wedge> wedges)
        : of_facet_(&of_facet), wedges_(wedges) {}

    /// A sequence of facets of this task: one more facet than another. The first is empty.
    struct Sequence {
        std::uint32_t parent = 0;
        FacetId facet = 0;
    };

    void push(FacetId facet) {
        sequences_.push_back({stack_.back(), facet});
        stack_.push_back(static_cast<std::uint32_t>(sequences_.size() - 1));
    }
    void pop() { stack_.pop_back(); }
    std::size_t order() const { return stack_.size() - 1; }

    void visit(const VisibleFacets& search) {
        ++frusta_;
        // A wedge belongs to two facets, and is tested once.
        thread_local std::vector<std::uint64_t> last_frustum;
        thread_local std::uint64_t frustum = 0;
        last_frustum.resize(std::max(last_frustum.size(), wedges_.size()), 0);
        ++frustum;
        for (const VisibleFacet& visible : search.found()) {
            for (const std::uint32_t wedge : (*of_facet_)[visible.facet]) {
                if (last_frustum[wedge] != frustum) {
                    last_frustum[wedge] = frustum;
                    if (search.may_arrive_on(wedges_[wedge].begin, wedges_[wedge].end)) {
                        pairs_.emplace_back(wedge, stack_.back());
                    }
                }
            }
        }
    }

    const std::vector<Sequence>& sequences() const { return sequences_; }
    std::vector<EdgeSides::Pair> take_pairs() { return std::move(pairs_); }
    std::uint64_t frusta() const { return frusta_; }

private:
    const std::vector<std::vector<std::uint32_t>>* of_facet_;
    std::span<const Wedge> wedges_;
    std::vector<Sequence> sequences_{{}};
    std::vector<std::uint32_t> stack_{0};
    std::vector<EdgeSides::Pair> pairs_;  // wedge, sequence
    std::uint64_t frusta_ = 0;
};

}  // namespace

EdgeTracer::EdgeTracer(const SceneView& scene,
                       const FacetIndex& index,
                       const PathVerifier& verifier,
                       std::span<const Wedge> wedges,
                       const TraceOptions& trace)
    : scene_(scene),
      index_(index),
      verifier_(verifier),
      wedges_(wedges),
      trace_(trace),
      wedges_of_facet_(wedges_by_facet(wedges, index.size())) {}

EdgeSides EdgeTracer::trace(const Vec3& point,
                            EdgeStatistics& statistics,
                            Executor& executor) const {
    // An edge lies on the border of a facet that faces the sound, or the sound runs in the planes
    // of both faces: such facets are kept.
    const BeamTracer tracer(index_,
                            trace_,
                            verifier_.contact_radius(),
                            glm::length(point),
                            trace_.max_order + 1,
                            GrazingFacets::keep);
    auto tasks = tracer.trace<EdgeCollector>(
        point, {}, [&] { return EdgeCollector(wedges_of_facet_, wedges_); }, executor, nullptr);
    ImageTree images(point);
    std::vector<std::vector<EdgeSides::Pair>> pairs;
    for (EdgeCollector& task : tasks) {
        statistics.frusta += task.frusta();
        std::vector<std::uint32_t> image_of(task.sequences().size(), 0);
        for (std::size_t i = 1; i < image_of.size(); ++i) {
            const EdgeCollector::Sequence& sequence = task.sequences()[i];
            image_of[i] = images.child(image_of[sequence.parent], sequence.facet, scene_);
        }
        pairs.push_back(task.take_pairs());
        for (auto& [wedge, image] : pairs.back()) {
            image = image_of[image];
        }
    }
    EdgeSides sides(scene_, verifier_, wedges_, std::move(images), pairs, executor);
    statistics.candidates += sides.size();
    return sides;
}

EdgeSides all_edge_sides(const SceneView& scene,
                         const PathVerifier& verifier,
                         std::span<const Wedge> wedges,
                         const Vec3& point,
                         int max_reflections) {
    ImageTree images(point);
    std::vector<EdgeSides::Pair> pairs;
    for (std::uint32_t image = 0; image < images.size(); ++image) {
        for (std::uint32_t wedge = 0; wedge < wedges.size(); ++wedge) {
            pairs.emplace_back(wedge, image);
        }
        const ImageSource last = images[image];
        if (last.order == static_cast<std::uint32_t>(max_reflections)) {
            continue;
        }
        for (FacetId facet = 0; facet < scene.facets.facets.size(); ++facet) {
            if (last.order == 0 || last.facet != facet) {
                images.child(image, facet, scene);
            }
        }
    }
    return {scene, verifier, wedges, std::move(images), std::span(&pairs, 1), Executor::serial()};
}

}  // namespace earshot::frustum
