// SPDX-License-Identifier: MIT
//
// Gathering coherent rays into packets, compiled once per instruction set.

#include "earshot/bvh/internal/ray_packet.h"
#include "earshot/bvh/kernels/float_ray-inl.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#if defined(EARSHOT_BVH_KERNELS_PACKET_GATHER_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef EARSHOT_BVH_KERNELS_PACKET_GATHER_INL_H
#undef EARSHOT_BVH_KERNELS_PACKET_GATHER_INL_H
#else
#define EARSHOT_BVH_KERNELS_PACKET_GATHER_INL_H
#endif

HWY_BEFORE_NAMESPACE();
namespace earshot::bvh::HWY_NAMESPACE {

// Wider packets overlap so many boxes that single rays are faster.
inline constexpr float kMaxSpread = 0.15F;
// Slopes are off by four roundings, and five from the central ray; twice that is left.
inline constexpr float kSlopeError = 0x1p-21F;
// Of a depth that is the product of two rounded numbers.
inline constexpr float kProductError = 0x1p-21F;

// Beyond everything, but below the infinite distance of no candidate.
inline constexpr float kMaxBound = std::numeric_limits<float>::max();

/// A group of rays, as slopes and depths along the axes of a packet.
struct PacketGroup {
    Float8 slope_x, slope_y, depth;
    std::uint32_t in_range;  ///< bit per ray: its bounds hold
};

/// The first ray of a packet, to which the others have to be similar.
class PacketGathering {
public:
    /// Sets what the packet's rays share. False: the first ray lies outside the range of FloatRay.
    HWY_INLINE bool begin(RayPacket& packet, const geometry::Ray& first, float reach) {
        FloatRay ray;
        if (!set_ray(ray, first, reach)) {
            return false;
        }
        std::copy_n(ray.axis, 3, axis_);
        std::copy_n(ray.axis, 3, packet.axis);
        for (std::size_t k = 0; k < 3; ++k) {
            packet.origin[k] = ray.origin[axis_[k]];
            packet.origin_rest[k] = ray.origin_rest[axis_[k]];
        }
        packet.sign = sign_ = ray.inverse_depth < 0.0F ? -1.0F : 1.0F;
        packet.corner_error = ray.corner_error;
        const float distance = std::max(std::max(std::abs(ray.origin[0]), std::abs(ray.origin[1])),
                                        std::abs(ray.origin[2]));
        packet.plane_error = 0x1p-19F * std::max(distance, reach);
        origin_ = Double4::load_unaligned(fields(first));
        slope_x_ = sign_ * ray.shear[axis_[0]];
        slope_y_ = sign_ * ray.shear[axis_[1]];
        return true;
    }

    /// Whether a ray starts where the first does.
    HWY_INLINE bool is_from_origin(const geometry::Ray& ray) const {
        const Double4 origin = Double4::load_unaligned(fields(ray));
        return (bits((origin <= origin_) & (origin_ <= origin)) & 7U) == 7U;
    }

    /// Eight rays; fewer are padded with the last.
    HWY_INLINE PacketGroup group(std::span<const geometry::Ray> rays) const {
        const double* rows[8];
        for (std::size_t i = 0; i < 8; ++i) {
            const geometry::Ray* const ray = &rays[std::min(i, rays.size() - 1)];
            rows[i] = fields(*ray) + 3;
            __builtin_prefetch(ray + RayPacket::kMaxRays);
        }
        Float8 lanes[4];  // direction and t_max
        load_transposed(rows, lanes);
        const Float8 size = lanes[axis_[2]] * Float8(sign_);
        const Float8 inverse = Float8(1.0F) / size;
        PacketGroup result;
        result.slope_x = lanes[axis_[0]] * inverse;
        result.slope_y = lanes[axis_[1]] * inverse;
        result.depth = lanes[3] * size;
        // What is not a number fails one of these.
        const Float8 one = Float8(1.0F);
        const Float8 max_spread = Float8(kMaxSpread);
        result.in_range = bits((Float8(kMinDirection) <= size) & (size <= Float8(kMaxDirection)) &
                               (abs(result.slope_x) <= one) & (abs(result.slope_y) <= one) &
                               (abs(result.slope_x - Float8(slope_x_)) <= max_spread) &
                               (abs(result.slope_y - Float8(slope_y_)) <= max_spread) &
                               (Float8(0.0F) <= lanes[3]));
        return result;
    }

private:
    static HWY_INLINE const double* fields(const geometry::Ray& ray) {
        return reinterpret_cast<const double*>(&ray);
    }

    std::uint32_t axis_[3];
    float sign_;
    float slope_x_, slope_y_;
    Double4 origin_;
};

/// Sets the central ray of a packet whose slopes are gathered, and pads its last group.
HWY_INLINE void finish_packet(RayPacket& packet) {
    const std::size_t count = packet.count;
    const std::size_t padded =
        (count + RayPacket::kGroup - 1) / RayPacket::kGroup * RayPacket::kGroup;
    for (std::size_t i = count; i < padded; ++i) {
        packet.slope_x[i] = packet.slope_x[count - 1];
        packet.slope_y[i] = packet.slope_y[count - 1];
        packet.bound[i] = packet.inside[i] = -std::numeric_limits<float>::infinity();
    }
    float* const slopes[2] = {packet.slope_x, packet.slope_y};
    for (std::size_t k = 0; k < 2; ++k) {
        Float16 lowest = Float16::load(slopes[k]);
        Float16 highest = lowest;
        for (std::size_t i = RayPacket::kGroup; i < padded; i += RayPacket::kGroup) {
            lowest = min(lowest, Float16::load(slopes[k] + i));
            highest = max(highest, Float16::load(slopes[k] + i));
        }
        const float lower = reduce_min(lowest);
        const float upper = reduce_max(highest);
        packet.middle[k] = 0.5F * (lower + upper);
        packet.spread[k] = 0.5F * (upper - lower) + kSlopeError;
        for (std::size_t i = 0; i < padded; i += RayPacket::kGroup) {
            (Float16::load(slopes[k] + i) - Float16(packet.middle[k])).store(slopes[k] + i);
        }
    }
    for (std::size_t i = 0; i < padded; i += RayPacket::kGroup) {
        Float16(std::numeric_limits<float>::infinity()).store(packet.candidate_near + i);
    }
    const bool is_negative[3] = {
        packet.middle[0] < 0.0F, packet.middle[1] < 0.0F, packet.sign < 0.0F};
    packet.order_shift = 0;
    for (std::size_t k = 0; k < 3; ++k) {
        packet.order_shift += is_negative[k] ? 3 << packet.axis[k] : 0;
    }
}

/// Gathers as many of the first rays as form a coherent packet, and returns how many: they have the
/// same origin, directions with the same largest component and its sign, slopes that differ little,
/// and lie within the range of FloatRay. 0 if the first does not.
HWY_INLINE std::size_t gather_packet(RayPacket& packet,
                                     std::span<const geometry::Ray> rays,
                                     float reach) {
    PacketGathering gathering;
    packet.count = 0;
    if (rays.empty() || !gathering.begin(packet, rays[0], reach)) {
        return 0;
    }
    const std::size_t max_count = std::min(rays.size(), RayPacket::kMaxRays);
    // What underflows is less than this.
    const Float8 tiny = Float8(0x1p-100F);
    bool is_complete = false;
    while (!is_complete && packet.count < max_count) {
        const std::size_t first = packet.count;
        const std::size_t count = std::min(max_count - first, std::size_t{8});
        const PacketGroup group = gathering.group(rays.subspan(first, count));
        group.slope_x.store(packet.slope_x + first);
        group.slope_y.store(packet.slope_y + first);
        const Float8 bound = mul_add(group.depth, Float8(1.0F + kProductError), tiny);
        min(bound, Float8(kMaxBound)).store(packet.bound + first);
        (group.depth * Float8(1.0F - kProductError)).store(packet.inside + first);
        std::uint32_t similar = 0;
        for (std::size_t i = 0; i < count; ++i) {
            similar |= (gathering.is_from_origin(rays[first + i]) ? 1U : 0U) << i;
        }
        const auto gathered = static_cast<std::size_t>(std::countr_one(similar & group.in_range));
        packet.count += gathered;
        is_complete = gathered < 8;
    }
    if (packet.count > 0) {
        finish_packet(packet);
    }
    return packet.count;
}

}  // namespace earshot::bvh::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
