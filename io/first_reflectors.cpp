// SPDX-License-Identifier: MIT
#include "earshot/io/internal/first_reflectors.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <map>
#include <utility>

namespace earshot::io {
namespace {

bool is_first_order(const propagation::Path& path) noexcept {
    return path.kind == propagation::PathKind::specular && path.order == 1;
}

FirstReflection reflection_of(const propagation::Path& path) noexcept {
    const double excess = path.length - glm::distance(path.points.front(), path.points.back());
    return {.point = path.points[1],
            .excess = excess,
            .delay = path.length > 0.0 ? path.delay * (excess / path.length) : 0.0};
}

double earliest(const FirstReflector& reflector) noexcept {
    double result = std::numeric_limits<double>::infinity();
    for (const std::optional<FirstReflection>& reflection : reflector.reflections) {
        result = reflection ? std::min(result, reflection->excess) : result;
    }
    return result;
}

}  // namespace

std::vector<FirstReflector> first_reflectors(
    std::span<const propagation::PairResult> pairs,
    std::span<const double> times,
    std::span<const std::uint32_t> patch_of_triangle,
    std::size_t max_count,
    const std::function<bool(std::uint32_t material)>& leave_out) {
    std::map<std::uint32_t, FirstReflector> of_patch;
    for (const propagation::PairResult& pair : pairs) {
        for (const propagation::Path& path : pair.paths) {
            if (!is_first_order(path) || leave_out(path.materials.front())) {
                continue;
            }
            const std::uint32_t patch = patch_of_triangle[path.triangles.front()];
            FirstReflector& reflector = of_patch[patch];
            reflector.patch = patch;
            reflector.material = path.materials.front();
            reflector.reflections.resize(times.size());
            const FirstReflection reflection = reflection_of(path);
            for (std::size_t frame = 0; frame < times.size(); ++frame) {
                std::optional<FirstReflection>& kept = reflector.reflections[frame];
                if (times[frame] == pair.time && (!kept || reflection.excess < kept->excess)) {
                    kept = reflection;
                }
            }
        }
    }
    std::vector<FirstReflector> result;
    for (auto& [patch, reflector] : of_patch) {
        result.push_back(std::move(reflector));
    }
    std::stable_sort(
        result.begin(), result.end(), [](const FirstReflector& a, const FirstReflector& b) {
            return earliest(a) < earliest(b);
        });
    result.resize(std::min(result.size(), max_count));
    return result;
}

}  // namespace earshot::io
