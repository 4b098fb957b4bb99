// SPDX-License-Identifier: MIT
#include "earshot/bvh/internal/coordinate_rules.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace earshot::bvh {
namespace {

/// The largest power of ten whose multiples single precision tells apart up to a coordinate.
double scale_for(double max_abs_coordinate) noexcept {
    // Rounding moves a coordinate by at most 2^-24 of the power of two below it.
    const double rounding = std::exp2(std::floor(std::log2(max_abs_coordinate)) - 24.0);
    constexpr double kMaxScale = 1e15;  // powers of ten up to here are whole doubles
    double scale = 10.0;
    while (10.0 * scale * rounding < 0.49 && scale < kMaxScale) {
        scale *= 10.0;
    }
    return scale;
}

/// Whether a rule restores every bit of a position.
bool restores(const ExactCoordinates& rule, const geometry::Vec3& position) noexcept {
    bool is_restored = true;
    for (int axis = 0; axis < 3; ++axis) {
        const double value = position[axis];
        const double restored = rule.restore(static_cast<float>(value));
        is_restored &=
            std::bit_cast<std::uint64_t>(restored) == std::bit_cast<std::uint64_t>(value);
    }
    return is_restored;
}

/// Calls visit(rule, is_held) for the rules that are held so far.
template <typename Visit>
void for_each_held(std::atomic<bool>& is_single,
                   std::atomic<bool>& is_decimal,
                   const ExactCoordinates& decimal,
                   const Visit& visit) {
    if (is_single.load(std::memory_order_relaxed)) {
        visit(ExactCoordinates::single(), is_single);
    }
    if (is_decimal.load(std::memory_order_relaxed)) {
        visit(decimal, is_decimal);
    }
}

}  // namespace

CoordinateRules::CoordinateRules(double max_abs_coordinate) noexcept
    : decimal_(ExactCoordinates::decimal(scale_for(max_abs_coordinate))),
      is_single_(true),
      is_decimal_(true) {}

CoordinateRules::CoordinateRules(const ExactCoordinates& candidate) noexcept
    : decimal_(candidate),
      is_single_(candidate == ExactCoordinates::single()),
      is_decimal_(candidate.are_known() && !is_single_) {}

void CoordinateRules::check(std::span<const geometry::Vec3> positions, Executor& executor) {
    constexpr std::size_t kGrain = 4096;
    executor.for_each(positions.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        const auto part = positions.subspan(begin, end - begin);
        const auto check_rule = [&](const ExactCoordinates& rule, std::atomic<bool>& is_held) {
            const auto is_restored = [&](const geometry::Vec3& at) { return restores(rule, at); };
            if (!std::all_of(part.begin(), part.end(), is_restored)) {
                is_held.store(false, std::memory_order_relaxed);
            }
        };
        for_each_held(is_single_, is_decimal_, decimal_, check_rule);
    });
}

void CoordinateRules::check(std::span<const std::uint32_t> triangles,
                            const geometry::MeshView& mesh) noexcept {
    const auto check_rule = [&](const ExactCoordinates& rule, std::atomic<bool>& is_held) {
        for (const std::uint32_t triangle : triangles) {
            for (const geometry::VertexId vertex : mesh.triangles[triangle]) {
                if (!restores(rule, mesh.positions[vertex])) {
                    is_held.store(false, std::memory_order_relaxed);
                }
            }
        }
    };
    for_each_held(is_single_, is_decimal_, decimal_, check_rule);
}

ExactCoordinates CoordinateRules::result() const noexcept {
    return is_single_ ? ExactCoordinates::single() : is_decimal_ ? decimal_ : ExactCoordinates();
}

}  // namespace earshot::bvh
