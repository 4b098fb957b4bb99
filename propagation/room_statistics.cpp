// SPDX-License-Identifier: MIT
#include "earshot/propagation/room_statistics.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/lambert.h"
#include "earshot/propagation/internal/spiral.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace earshot::propagation {

using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

constexpr std::size_t kRays = 1024;  // of all sources together
constexpr std::size_t kChunk = 64;   // rays that are traced together
/// Reflections until a ray has forgotten its source, and reflections that count after these.
constexpr std::uint64_t kMixingReflections = 8;
constexpr std::uint64_t kReflections = 64;
constexpr std::uint64_t kSeed = 1;

/// Rays start this far from a surface, re the extent of the scene: as those of late sound do.
constexpr double kSelfIntersectionOffset = 0x1p-32;

/// A ray that leaves a side of a triangle.
struct Departure {
    std::uint32_t side = 0;  // 2 * triangle + 1 for the back
    std::uint32_t ray = 0;
    double length = 0.0;  // metres to the next surface; negative: there is none
};

/// The departures from one side.
struct SideCount {
    std::uint32_t departures = 0, escapes = 0;
    std::uint32_t first_ray = 0;
    bool is_of_one_ray = true;
    double length = 0.0;  // metres, sum over the departures that did not escape
};

/// Rays of one chunk, which the surfaces reflect by Lambert's law.
class DiffuseWalk {
public:
    DiffuseWalk(const RayScene& scene, double offset) : scene_(scene), offset_(offset) {}

    /// Departures in the order of reflections, then of rays. A ray that escapes departs again from
    /// where it was: this leaves the stationary distribution of departures uniform over the
    /// surface, as the probabilities of going from one place to another stay symmetric.
    std::vector<Departure> run(std::span<const Ray> rays, std::uint32_t first_id) {
        start(rays, first_id);
        std::vector<Departure> departures;
        std::vector<std::optional<geometry::Hit>> hits(at_.size());
        std::vector<Ray> legs(at_.size());
        std::vector<TriangleId> origins(at_.size());
        for (std::uint64_t n = 1; n <= kMixingReflections + kReflections && !at_.empty(); ++n) {
            const RandomStream random(kSeed, n);
            for (std::size_t i = 0; i < at_.size(); ++i) {
                legs[i] = {at_[i].point + offset_ * at_[i].normal,
                           lambert_direction(at_[i].normal, random.bits(at_[i].id))};
                origins[i] = at_[i].side / 2;
            }
            scene_.bvh.closest_hits(bvh::SecondaryRays{.rays = legs, .origin_triangles = origins},
                                    hits);
            for (std::size_t i = 0; i < at_.size(); ++i) {
                if (n > kMixingReflections) {
                    departures.push_back({at_[i].side, at_[i].id, hits[i] ? hits[i]->t : -1.0});
                }
                if (hits[i]) {
                    arrive(legs[i], *hits[i], at_[i]);
                }
            }
        }
        return departures;
    }

private:
    struct Place {
        std::uint32_t id = 0;
        std::uint32_t side = 0;
        Vec3 point{0.0}, normal{0.0};  // the normal points to where the ray came from
    };

    /// The rays that meet a surface at all.
    void start(std::span<const Ray> rays, std::uint32_t first_id) {
        const auto hits = scene_.bvh.closest_hits(rays);
        at_.clear();
        for (std::size_t i = 0; i < rays.size(); ++i) {
            if (hits[i]) {
                at_.push_back({.id = first_id + static_cast<std::uint32_t>(i)});
                arrive(rays[i], *hits[i], at_.back());
            }
        }
    }

    void arrive(const Ray& ray, const geometry::Hit& hit, Place& place) const {
        const auto [a, b, c] = scene_.bvh.corners(hit.triangle);
        const Vec3 front = glm::normalize(glm::cross(b - a, c - a));
        const bool is_back = glm::dot(front, ray.direction) > 0.0;
        place.side = 2 * static_cast<std::uint32_t>(hit.triangle) + (is_back ? 1 : 0);
        place.normal = is_back ? -front : front;
        place.point = ray.origin + hit.t * ray.direction;
    }

    const RayScene& scene_;
    double offset_;
    std::vector<Place> at_;
};

std::vector<SideCount> count_departures(const RayScene& scene,
                                        std::span<const Vec3> sources,
                                        Executor& executor) {
    double extent = scene.bvh.max_abs_coordinate();
    std::vector<Ray> rays;
    for (std::size_t source = 0; source < sources.size(); ++source) {
        extent = std::max(extent, glm::length(sources[source]));
        const std::size_t count =
            (source + 1) * kRays / sources.size() - source * kRays / sources.size();
        for (std::size_t i = 0; i < count; ++i) {
            rays.push_back({sources[source], spiral_direction(i, static_cast<double>(count))});
        }
    }
    std::vector<std::vector<Departure>> chunks(chunk_count(rays.size(), kChunk));
    executor.for_each(rays.size(), kChunk, [&](std::size_t begin, std::size_t end) {
        DiffuseWalk walk(scene, kSelfIntersectionOffset * extent);
        chunks[begin / kChunk] = walk.run(std::span(rays).subspan(begin, end - begin),
                                          static_cast<std::uint32_t>(begin));
    });
    std::vector<SideCount> sides(2 * scene.mesh().triangles.size());
    for (const std::vector<Departure>& chunk : chunks) {
        for (const Departure& departure : chunk) {
            SideCount& side = sides[departure.side];
            if (side.departures++ == 0) {
                side.first_ray = departure.ray;
            }
            side.is_of_one_ray = side.is_of_one_ray && departure.ray == side.first_ray;
            if (departure.length < 0.0) {
                ++side.escapes;
            } else {
                side.length += departure.length;
            }
        }
    }
    return sides;
}

/// Sums over sides of triangles, with a weight each.
struct SideSums {
    double weight = 0.0;
    double escapes = 0.0;          // weight times the share of departures that escape
    double length = 0.0;           // weight times mean length times the share that does not escape
    audio::Spectrum absorption{};  // weight times absorption coefficient

    void add(double of_side, const SideCount& side, const audio::Spectrum& absorbed) {
        weight += of_side;
        escapes += of_side / side.departures * side.escapes;
        length += of_side / side.departures * side.length;
        add_to_absorption(of_side, absorbed);
    }
    void add(double factor, const SideSums& sums) {
        weight += factor * sums.weight;
        escapes += factor * sums.escapes;
        length += factor * sums.length;
        add_to_absorption(factor, sums.absorption);
    }

private:
    void add_to_absorption(double factor, const audio::Spectrum& spectrum) {
        for (std::size_t band = 0; band < spectrum.size(); ++band) {
            absorption[band] += factor * spectrum[band];
        }
    }
};

/// Sums over all sides that sound reaches, weighted by area rather than by departures, which the
/// source's part of the scene has more of as long as sound has not spread evenly.
SideSums sum_over_area(const RayScene& scene,
                       std::span<const SideCount> sides,
                       const audio::Bands& bands) {
    std::vector<audio::Spectrum> absorption;
    for (const Material& material : scene.materials) {
        absorption.push_back(material.absorption.over(bands));
    }
    audio::Spectrum all;
    all.fill(1.0);
    SideSums by_area, of_one_ray;
    double departures = 0.0;
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const SideCount& side = sides[i];
        if (side.departures == 0) {
            continue;
        }
        const auto [a, b, c] = scene.bvh.corners(static_cast<TriangleId>(i / 2));
        const double area = 0.5 * glm::length(glm::cross(b - a, c - a));
        const std::uint32_t material = scene.material_of_triangle[i / 2];
        const bool is_dead_back = i % 2 == 1 && scene.materials[material].one_sided;
        const audio::Spectrum& absorbed = is_dead_back ? all : absorption[material];
        by_area.add(area, side, absorbed);
        if (side.is_of_one_ray) {
            of_one_ray.add(side.departures, side, absorbed);
        }
        departures += side.departures;
    }
    // The departures of one more ray from sides without departures, estimated by leaving out each
    // ray in turn (Good 1953): their share in all departures is that of these sides in the area, as
    // departures are uniform over it. A ray counts whole, since in a narrow gap it goes to and fro
    // between the same sides.
    if (of_one_ray.weight > 0.0) {
        constexpr double kMinReachedShare = 0.01;
        const double reached = std::max(kMinReachedShare, 1.0 - of_one_ray.weight / departures);
        const double unreached_area = by_area.weight * (1.0 / reached - 1.0);
        by_area.add(unreached_area / of_one_ray.weight, of_one_ray);
    }
    return by_area;
}

/// The reverberation times of a room whose volume, surface, opening and absorption are known.
void set_times(const RoomStatisticsOptions& options, RoomStatistics& room) {
    // Kuttruff 2009, chapter 5.
    const double factor = 24.0 * math::log(10.0) / speed_of_sound(options.air) * room.volume;
    const double boundary = room.surface + room.opening;
    const audio::Spectrum air = air_pressure(options.air, options.bands, 1.0);
    for (std::size_t band = 0; band < options.bands.count(); ++band) {
        const double mean = room.absorption[band];
        const double by_air =
            options.air_absorption ? -8.0 * math::log(air[band]) * room.volume : 0.0;
        room.sabine[band] = factor / (boundary * mean + by_air);
        room.eyring[band] = mean < 1.0 ? factor / (by_air - boundary * math::log(1.0 - mean)) : 0.0;
    }
}

}  // namespace

std::optional<RoomStatistics> room_statistics(const RayScene& scene,
                                              std::span<const Vec3> sources,
                                              const RoomStatisticsOptions& options,
                                              Executor& executor) {
    constexpr double kMaxEscapes = 0.5;
    if (sources.empty()) {
        return std::nullopt;
    }
    const SideSums sums =
        sum_over_area(scene, count_departures(scene, sources, executor), options.bands);
    if (!(sums.length > 0.0) || sums.escapes > kMaxEscapes * sums.weight) {
        return std::nullopt;
    }
    RoomStatistics room;
    room.surface = sums.weight;
    room.opening = sums.escapes;  // by reciprocity: as many rays would come in as leave
    const double boundary = room.surface + room.opening;
    const double mean_free_path = sums.length / (sums.weight - sums.escapes);
    room.volume = 0.25 * mean_free_path * boundary;
    for (std::size_t band = 0; band < options.bands.count(); ++band) {
        room.absorption[band] = std::min(1.0, (sums.absorption[band] + room.opening) / boundary);
    }
    set_times(options, room);
    return room;
}

}  // namespace earshot::propagation
