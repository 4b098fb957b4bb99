// SPDX-License-Identifier: MIT
#include "earshot/bvh/closest_point.h"

#include "earshot/bvh/internal/closest_point_search.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::ClosestPoint;
using geometry::PreparedPoint;
using geometry::Vec3;

namespace {

/// Keeps the k closest candidates, as a heap with the farthest on top.
class KClosest {
public:
    KClosest(std::size_t k, double max_distance) : k_(k), max_distance_(max_distance) {}

    double max_distance() const noexcept { return max_distance_; }
    void add(const ClosestPoint& candidate) {
        if (heap_.size() == k_) {
            if (!is_closer(candidate, heap_.front())) {
                return;
            }
            std::pop_heap(heap_.begin(), heap_.end(), is_closer);
            heap_.pop_back();
        }
        heap_.push_back(candidate);
        std::push_heap(heap_.begin(), heap_.end(), is_closer);
        if (heap_.size() == k_) {
            max_distance_ = heap_.front().distance;
        }
    }
    std::vector<ClosestPoint> sorted() && {
        std::sort_heap(heap_.begin(), heap_.end(), is_closer);
        return std::move(heap_);
    }

private:
    std::vector<ClosestPoint> heap_;
    std::size_t k_;
    double max_distance_;
};

}  // namespace

std::optional<ClosestPoint> closest_point(const Tree& tree,
                                          const geometry::MeshView& mesh,
                                          const Vec3& point,
                                          double max_distance) noexcept {
    ClosestCollector closest(max_distance);
    search_closest_points(tree, mesh, PreparedPoint(point), closest);
    return closest.best();
}

std::vector<ClosestPoint> closest_triangles(const Tree& tree,
                                            const geometry::MeshView& mesh,
                                            const Vec3& point,
                                            std::size_t count,
                                            double max_distance) {
    if (count == 0) {
        return {};
    }
    KClosest closest(count, max_distance);
    search_closest_points(tree, mesh, PreparedPoint(point), closest);
    return std::move(closest).sorted();
}

}  // namespace earshot::bvh
