// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/internal/screw_ccd.h"

#include "earshot/collision/narrow_phase/min_separation.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <vector>

namespace earshot::collision {

using geometry::Vec3;

namespace {

/// What the two kinds of queries differ in.
struct VertexFace {
    static constexpr std::size_t kFirstPoints = 1;
    static std::optional<double> ccd(const MovingPoints& points,
                                     const MinSeparationOptions& options) {
        return vertex_face_min_separation_ccd(points, options);
    }
};
struct EdgeEdge {
    static constexpr std::size_t kFirstPoints = 2;
    static std::optional<double> ccd(const MovingPoints& points,
                                     const MinSeparationOptions& options) {
        return edge_edge_min_separation_ccd(points, options);
    }
};

struct Interval {
    double begin = 0.0, end = 1.0;
};

template <class Features>
class ScrewSearch {
public:
    explicit ScrewSearch(const ScrewPoints& points, double min_separation)
        : points_(points), min_separation_(min_separation) {
        Vec3 lower = points.begin[0], upper = points.begin[0];
        for (std::size_t i = 0; i < 4; ++i) {
            const bool is_first = i < Features::kFirstPoints;
            const Screw* screw = is_first ? points.first : points.second;
            if (screw != nullptr) {
                double& deviation = is_first ? deviation_[0] : deviation_[1];
                deviation = std::max(deviation, screw->chord_deviation(points.begin[i]));
            }
            for (const double time : {0.0, 1.0}) {
                const Vec3 position = points.at(i, Features::kFirstPoints, time);
                lower = glm::min(lower, position);
                upper = glm::max(upper, position);
                const Vec3 sizes = glm::abs(position);
                largest_ = std::max({largest_, sizes.x, sizes.y, sizes.z});
            }
        }
        tolerance_ = kTolerance * glm::length(upper - lower) + kRounding * largest_ + 1e-290;
    }

    std::optional<double> run() const {
        constexpr int kMaxIntervals = 10000;
        std::vector<Interval> stack{{}};
        for (int tested = 0; !stack.empty(); ++tested) {
            const Interval interval = stack.back();
            stack.pop_back();
            const double width = interval.end - interval.begin;
            const double deviation = (deviation_[0] + deviation_[1]) * width * width;
            const auto toi =
                Features::ccd(chords(interval),
                              {.min_separation = min_separation_ + deviation + kRounding * largest_,
                               .tolerance = std::max(deviation, tolerance_)});
            if (!toi) {
                continue;
            }
            // The contact is not before this.
            const double begin = interval.begin + *toi * width * (1.0 - 0x1p-50);
            if (deviation <= tolerance_ || tested >= kMaxIntervals) {
                return begin;
            }
            const double middle = 0.5 * (begin + interval.end);
            if (!(begin < middle && middle < interval.end)) {
                return begin;
            }
            stack.push_back({middle, interval.end});
            stack.push_back({begin, middle});
        }
        return std::nullopt;
    }

private:
    /// Of the extent of the motion.
    static constexpr double kTolerance = 0x1p-30;
    /// Of the largest coordinate: some 20 roundings of points on screws.
    static constexpr double kRounding = 0x1p-47;

    MovingPoints chords(const Interval& interval) const {
        MovingPoints chords;
        for (std::size_t i = 0; i < 4; ++i) {
            chords.begin[i] = points_.at(i, Features::kFirstPoints, interval.begin);
            chords.end[i] = points_.at(i, Features::kFirstPoints, interval.end);
        }
        return chords;
    }

    const ScrewPoints& points_;
    double min_separation_;
    std::array<double, 2> deviation_{};  // of both bodies' points from chords of the whole step
    double largest_ = 0.0;
    double tolerance_ = 0.0;
};

}  // namespace

Vec3 ScrewPoints::at(std::size_t i, std::size_t first_points, double time) const noexcept {
    const Screw* screw = i < first_points ? first : second;
    return screw != nullptr ? screw->apply(begin[i], time) : begin[i] + time * (end[i] - begin[i]);
}

std::optional<double> vertex_face_screw_ccd(const ScrewPoints& points, double min_separation) {
    return ScrewSearch<VertexFace>(points, min_separation).run();
}

std::optional<double> edge_edge_screw_ccd(const ScrewPoints& points, double min_separation) {
    return ScrewSearch<EdgeEdge>(points, min_separation).run();
}

}  // namespace earshot::collision
