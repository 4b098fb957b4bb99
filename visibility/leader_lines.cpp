// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/leader_lines.h"

#include "earshot/base/math.h"
#include "earshot/visibility/internal/object_area.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>

namespace earshot::visibility {
namespace {

using glm::dvec2;

using Candidates = std::vector<LeaderLine>;

double weighted(double membership, double weight) noexcept {
    if (weight == 1.0 || membership <= 0.0) {
        return weight == 0.0 ? 1.0 : std::max(membership, 0.0);
    }
    return math::pow(membership, weight);
}

/// Greedy optimisation of the leader lines.
class Greedy {
public:
    Greedy(const IdImage& image,
           std::span<const LabelledObject> objects,
           const LabelOptions& options,
           const LabelInterior& interior,
           const LabelLayout* previous)
        : options_(options), interior_(interior), diagonal_(interior.diagonal()) {
        collect(image, objects);
        rate(previous);
    }

    /// One leader line per object that has candidates.
    std::vector<std::optional<LeaderLine>> run() {
        std::vector<std::optional<LeaderLine>> placed(candidates_.size());
        for (;;) {
            const std::size_t next = next_object(placed);
            if (next == candidates_.size()) {
                return placed;
            }
            const Candidates& candidates = candidates_[next];
            placed[next] = *std::max_element(
                candidates.begin(), candidates.end(), [](const LeaderLine& a, const LeaderLine& b) {
                    return a.feasibility < b.feasibility;
                });
            for (std::size_t other = 0; other < candidates_.size(); ++other) {
                if (!placed[other]) {
                    keep_away(candidates_[other], *placed[next]);
                }
            }
        }
    }

private:
    /// The leader lines of an anchor, the shorter one first; a side that labels must not stand at
    /// has none.
    Candidates lines_of(const dvec2& anchor) const {
        const auto line = [&](bool is_left) {
            return LeaderLine{.anchor = anchor,
                              .end = {interior_.side(is_left).x(anchor.y), anchor.y},
                              .is_left = is_left};
        };
        const LeaderLine left = line(true), right = line(false);
        if (options_.sides != LabelSides::both) {
            return {options_.sides == LabelSides::left ? left : right};
        }
        return anchor.x - left.end.x <= right.end.x - anchor.x ? Candidates{left, right}
                                                               : Candidates{right, left};
    }

    void collect(const IdImage& image, std::span<const LabelledObject> objects) {
        candidates_.resize(objects.size());
        std::vector<std::vector<std::size_t>> pixels(objects.size());
        for (std::size_t pixel = 0; pixel < image.objects.size(); ++pixel) {
            const std::uint32_t object = image.objects[pixel];
            if (object < objects.size()) {
                pixels[object].push_back(pixel);
            }
        }
        for (std::size_t object = 0; object < objects.size(); ++object) {
            fixed_.push_back(objects[object].anchor);
            if (objects[object].anchor) {
                candidates_[object] = lines_of(*objects[object].anchor);
            } else if (!pixels[object].empty()) {
                const ObjectArea area(image, static_cast<std::uint32_t>(object), pixels[object]);
                for (const std::size_t pixel : pixels[object]) {
                    // Section 5.1: the shorter leader line, which follows from the anchor.
                    candidates_[object].push_back(
                        lines_of({static_cast<double>(pixel % image.width) + 0.5,
                                  static_cast<double>(pixel / image.width) + 0.5})
                            .front());
                    candidates_[object].back().salience = area.distance_outside(pixel);
                }
            }
        }
    }

    /// How far a line stays away from the fixed anchors of other objects.
    double clearance(const LeaderLine& line, std::size_t object) const noexcept {
        double nearest = std::numeric_limits<double>::infinity();
        const double low = std::min(line.anchor.x, line.end.x);
        const double high = std::max(line.anchor.x, line.end.x);
        for (std::size_t other = 0; other < fixed_.size(); ++other) {
            if (other != object && fixed_[other]) {
                const dvec2& point = *fixed_[other];
                nearest = std::min(
                    nearest, glm::distance(point, {std::clamp(point.x, low, high), line.anchor.y}));
            }
        }
        return nearest;
    }

    /// Equations (2), (3), (8) and (9), aggregated by (12), and the clearance of lines.
    void rate(const LabelLayout* previous) {
        double longest = 0.0;
        for (const Candidates& candidates : candidates_) {
            for (const LeaderLine& line : candidates) {
                longest = std::max(longest, glm::distance(line.anchor, line.end));
            }
        }
        const LabelWeights& weights = options_.weights;
        for (std::size_t object = 0; object < candidates_.size(); ++object) {
            const Label* before = previous != nullptr && previous->labels[object]
                                      ? &*previous->labels[object]
                                      : nullptr;
            for (LeaderLine& line : candidates_[object]) {
                if (longest > 0.0) {
                    const double length = glm::distance(line.anchor, line.end) / longest;
                    line.feasibility = weighted(1.0 - length, weights.leader_length) *
                                       weighted(line.salience / longest, weights.anchor_salience);
                }
                const double clear = clearance(line, object) / options_.box_height;
                line.feasibility *= weighted(std::min(clear, 1.0), weights.line_clearance);
                if (before != nullptr) {
                    const double moved = glm::distance(line.anchor, before->anchor) / diagonal_;
                    const double end_moved = glm::distance(line.end, before->end) / diagonal_;
                    line.feasibility *= weighted(1.0 - moved, weights.anchor_coherence) *
                                        weighted(1.0 - end_moved, weights.end_coherence);
                }
            }
        }
    }

    /// Section 5.4: first comes the object that has the least feasible candidates. Equation (14) as
    /// printed, with the greatest sum of 1 - F first, prefers large areas, which the text excludes.
    /// Fixed anchors have the least freedom and precede all others.
    std::size_t next_object(const std::vector<std::optional<LeaderLine>>& placed) const {
        std::size_t best = candidates_.size();
        std::pair best_rank(true, std::numeric_limits<double>::infinity());  // floats, sum
        for (std::size_t object = 0; object < candidates_.size(); ++object) {
            if (placed[object] || candidates_[object].empty()) {
                continue;
            }
            double sum = 0.0;
            for (const LeaderLine& line : candidates_[object]) {
                sum += line.feasibility;
            }
            const std::pair rank(!fixed_[object].has_value(), sum);
            if (rank < best_rank) {
                best_rank = rank;
                best = object;
            }
        }
        return best;
    }

    /// Equations (4) to (7): what the line just placed leaves of the feasibility of others.
    void keep_away(Candidates& candidates, const LeaderLine& placed) const {
        const double wanted = options_.min_anchor_distance * diagonal_;
        for (LeaderLine& line : candidates) {
            const double anchors = glm::distance(line.anchor, placed.anchor);
            const double ends = glm::distance(line.end, placed.end);
            if (anchors < wanted) {
                line.feasibility *= weighted(anchors / wanted, options_.weights.anchor_distance);
            }
            if (ends < options_.box_height) {
                line.feasibility *=
                    weighted(ends / options_.box_height, options_.weights.end_distance);
            }
        }
    }

    const LabelOptions& options_;
    const LabelInterior& interior_;
    double diagonal_;
    std::vector<Candidates> candidates_;
    std::vector<std::optional<dvec2>> fixed_;  // anchors
};

}  // namespace

std::vector<std::optional<LeaderLine>> place_leader_lines(const IdImage& image,
                                                          std::span<const LabelledObject> objects,
                                                          const LabelOptions& options,
                                                          const LabelInterior& interior,
                                                          const LabelLayout* previous) {
    return Greedy(image, objects, options, interior, previous).run();
}

}  // namespace earshot::visibility
