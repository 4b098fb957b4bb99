// SPDX-License-Identifier: MIT
// The loops of python_loops.py in C++: a library that it loads, with the modules inside.
#include "earshot/base/digest.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/earshot.h"
#include "earshot/propagation/room_shapes.h"
#include "earshot/visibility/line_of_sight.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#define BENCH_API __attribute__((visibility("default")))

extern "C" {

/// Rooms of one source each; arrays are row by row.
struct BenchRooms {
    const double* sizes;       ///< (rooms, 3) metres
    const double* absorption;  ///< (rooms) of energy
    const double* sources;     ///< (rooms, 3)
    const double* listeners;   ///< (rooms, listener_count, 3)
    std::uint64_t listener_count;
    std::uint64_t rays;
    double sample_rate;
    double length;
    std::int32_t order;
};

/// Lines of sight through a mesh.
struct BenchSight {
    std::vector<earshot::Vec3> positions;
    std::vector<earshot::geometry::Triangle> triangles;
    std::vector<earshot::geometry::Segment> segments;
    earshot::bvh::DeformableBvh tree{};
};

BENCH_API std::uint64_t bench_digest(const void* bytes, std::uint64_t size);
BENCH_API int bench_rooms(const BenchRooms* rooms,
                          std::uint64_t begin,
                          std::uint64_t end,
                          std::uint64_t* digests);
BENCH_API BenchSight* bench_sight_create(const double* vertices,
                                         std::uint64_t vertex_count,
                                         const std::uint32_t* triangles,
                                         std::uint64_t triangle_count,
                                         const double* from,
                                         const double* to,
                                         std::uint64_t segment_count);
BENCH_API void bench_sight_destroy(BenchSight* sight);
BENCH_API void bench_sight(const BenchSight* sight, std::uint8_t* visible);
}

namespace {

using earshot::Vec3;

Vec3 point(const double* numbers, std::size_t row) {
    return {numbers[3 * row], numbers[3 * row + 1], numbers[3 * row + 2]};
}

earshot::Room make_room(const BenchRooms& rooms, std::size_t index) {
    earshot::Room room{.scene = earshot::propagation::shoebox_room(point(rooms.sizes, index))};
    for (earshot::propagation::Material& material : room.scene.materials) {
        material.absorption = earshot::propagation::EnergyCoefficient(rooms.absorption[index]);
        material.scattering = earshot::propagation::EnergyCoefficient(0.1);
    }
    room.add_source("talker", point(rooms.sources, index));
    for (std::size_t i = 0; i < rooms.listener_count; ++i) {
        room.add_listener("microphone " + std::to_string(i + 1),
                          point(rooms.listeners, index * rooms.listener_count + i));
    }
    return room;
}

/// Of all samples as floats, one listener after the other.
std::uint64_t digest_of(const earshot::Responses& responses) {
    std::vector<float> samples;
    for (const earshot::Response& response : responses) {
        for (const double sample : response.channels.front().samples) {
            samples.push_back(static_cast<float>(sample));
        }
    }
    return bench_digest(samples.data(), samples.size() * sizeof(float));
}

}  // namespace

std::uint64_t bench_digest(const void* bytes, std::uint64_t size) {
    earshot::Digest digest;
    digest.add_bytes({static_cast<const std::byte*>(bytes), size});
    return digest.value();
}

/// Simulates rooms [begin, end) one by one; their digests go to `digests` unless it is null.
/// Returns 0, or 1 after an Error.
int bench_rooms(const BenchRooms* rooms,
                std::uint64_t begin,
                std::uint64_t end,
                std::uint64_t* digests) {
    earshot::propagation::ResponseFormat format;
    format.sample_rate = rooms->sample_rate;
    format.length = rooms->length;
    format.report_metrics = false;
    const earshot::SimulationOptions options = {.order = rooms->order,
                                                .rays = rooms->rays,
                                                .max_error = 0.0,
                                                .format = format,
                                                .threads = 1};
    try {
        for (std::uint64_t index = begin; index < end; ++index) {
            const earshot::Room room = make_room(*rooms, index);
            const earshot::Responses responses = earshot::simulate(room, options);
            if (digests != nullptr) {
                digests[index] = digest_of(responses);
            }
        }
    } catch (const earshot::Error&) {
        return 1;
    }
    return 0;
}

BenchSight* bench_sight_create(const double* vertices,
                               std::uint64_t vertex_count,
                               const std::uint32_t* triangles,
                               std::uint64_t triangle_count,
                               const double* from,
                               const double* to,
                               std::uint64_t segment_count) {
    auto sight = std::make_unique<BenchSight>();
    for (std::size_t i = 0; i < vertex_count; ++i) {
        sight->positions.push_back(point(vertices, i));
    }
    for (std::size_t i = 0; i < triangle_count; ++i) {
        sight->triangles.push_back({triangles[3 * i], triangles[3 * i + 1], triangles[3 * i + 2]});
    }
    for (std::size_t i = 0; i < segment_count; ++i) {
        sight->segments.push_back({point(from, i), point(to, i)});
    }
    sight->tree = earshot::bvh::DeformableBvh(
        earshot::geometry::MeshView{sight->positions, sight->triangles});
    return sight.release();
}

void bench_sight_destroy(BenchSight* sight) {
    delete sight;
}

/// Tests all lines of sight on this thread: 1 or 0 each.
void bench_sight(const BenchSight* sight, std::uint8_t* visible) {
    const std::vector<std::uint8_t> found =
        earshot::visibility::visible(sight->tree.view(), sight->segments);
    std::copy(found.begin(), found.end(), visible);
}
