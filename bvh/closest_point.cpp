// SPDX-License-Identifier: MIT
#include "earshot/bvh/closest_point.h"

#include "earshot/bvh/internal/nearest_search.h"

#include <algorithm>

namespace earshot::bvh {

using geometry::NearPoint;
using geometry::PreparedPoint;
using geometry::Vec3;

namespace {

/// Keeps the first in order.
class Nearest {
public:
    explicit Nearest(double most) noexcept : most_(most) {}

    double most() const noexcept { return most_; }
    void add(const NearPoint& found) noexcept {
        if (!best_ || comes_before(found, *best_)) {
            best_ = found;
            most_ = found.distance;
        }
    }
    const std::optional<NearPoint>& best() const noexcept { return best_; }

private:
    std::optional<NearPoint> best_;
    double most_;
};

/// Keeps the first `count` in order, as a heap with the last on top.
class NearestFew {
public:
    NearestFew(std::size_t count, double most) : count_(count), most_(most) {}

    double most() const noexcept { return most_; }
    void add(const NearPoint& found) {
        if (found_.size() == count_) {
            if (!comes_before(found, found_.front())) {
                return;
            }
            std::pop_heap(found_.begin(), found_.end(), comes_before);
            found_.pop_back();
        }
        found_.push_back(found);
        std::push_heap(found_.begin(), found_.end(), comes_before);
        if (found_.size() == count_) {
            most_ = found_.front().distance;
        }
    }
    std::vector<NearPoint> in_order() && {
        std::sort_heap(found_.begin(), found_.end(), comes_before);
        return std::move(found_);
    }

private:
    std::vector<NearPoint> found_;
    std::size_t count_;
    double most_;
};

}  // namespace

std::optional<NearPoint> closest_point(const Tree& tree,
                                       const geometry::MeshView& mesh,
                                       const Vec3& point,
                                       double most) noexcept {
    Nearest nearest(most);
    search_nearest(tree, mesh, PreparedPoint(point), nearest);
    return nearest.best();
}

std::vector<NearPoint> nearest_triangles(const Tree& tree,
                                         const geometry::MeshView& mesh,
                                         const Vec3& point,
                                         std::size_t count,
                                         double most) {
    if (count == 0) {
        return {};
    }
    NearestFew nearest(count, most);
    search_nearest(tree, mesh, PreparedPoint(point), nearest);
    return std::move(nearest).in_order();
}

}  // namespace earshot::bvh
