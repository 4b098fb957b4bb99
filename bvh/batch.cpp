// SPDX-License-Identifier: MIT
#include "earshot/bvh/batch.h"

#include "earshot/bvh/closest_point.h"
#include "earshot/bvh/ray.h"

#include <cstddef>

namespace earshot::bvh {

using geometry::ClosestPoint;
using geometry::Hit;

namespace {

// Long enough for a task's start, short enough to share out unequal questions.
constexpr std::size_t kGrain = 256;

template <class Result, class Question, class Answer>
std::vector<Result> answer_all(std::span<const Question> questions,
                               Executor& executor,
                               const Answer& answer) {
    std::vector<Result> results(questions.size());
    executor.for_each(questions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            results[i] = answer(questions[i]);
        }
    });
    return results;
}

}  // namespace

std::vector<std::optional<Hit>> closest_hits(const Tree& tree,
                                             const geometry::MeshView& mesh,
                                             std::span<const geometry::Ray> rays,
                                             Executor& executor) {
    return answer_all<std::optional<Hit>>(
        rays, executor, [&](const geometry::Ray& ray) { return closest_hit(tree, mesh, ray); });
}

std::vector<std::uint8_t> occluded(const Tree& tree,
                                   const geometry::MeshView& mesh,
                                   std::span<const geometry::Segment> segments,
                                   Executor& executor) {
    return answer_all<std::uint8_t>(
        segments, executor, [&](const geometry::Segment& segment) -> std::uint8_t {
            return occluded(tree, mesh, segment) ? 1 : 0;
        });
}

std::vector<std::optional<ClosestPoint>> closest_points(const Tree& tree,
                                                        const geometry::MeshView& mesh,
                                                        std::span<const geometry::Vec3> points,
                                                        double most,
                                                        Executor& executor) {
    return answer_all<std::optional<ClosestPoint>>(
        points, executor, [&](const geometry::Vec3& point) {
            return closest_point(tree, mesh, point, most);
        });
}

}  // namespace earshot::bvh
