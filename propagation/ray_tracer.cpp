// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/ray_tracer.h"

#include "earshot/base/math.h"
#include "earshot/base/random.h"
#include "earshot/propagation/internal/spiral.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

namespace earshot::propagation {

using geometry::Ray;
using geometry::TriangleId;
using geometry::Vec3;

namespace {

// The back of a one-sided material absorbs everything, so that sound passes only from its front to
// its back, and reversed rays from its back to its front.
RaySurface without_transmission(RaySurface surface) {
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        surface.absorbed[band] += std::exchange(surface.transmitted[band], 0.0);
    }
    set_probabilities(surface);
    return surface;
}

RaySurface transmission_alone(RaySurface surface) {
    surface.specular.fill(0.0);
    surface.scattered.fill(0.0);
    for (std::size_t band = 0; band < surface.kept.size(); ++band) {
        surface.absorbed[band] = 1.0 - surface.transmitted[band];
    }
    set_probabilities(surface);
    return surface;
}

}  // namespace

RayTracer::RayTracer(const RayScene& scene,
                     const RaySource& source,
                     std::span<const Vec3> listeners,
                     const RayOptions& options,
                     Executor& executor)
    : scene_(scene),
      source_(source),
      options_(options),
      bands_(options.bands.count()),
      self_intersection_offset_(kSelfIntersectionOffset * (scene.bvh.max_abs_coordinate() +
                                                           glm::length(source.pose.position))) {
    describe_surfaces();
    describe_triangles();
    rectangular_room_ = find_rectangular_room();
    scattered_radius_ = scattered_radius();
    describe_receivers(listeners, executor);
    set_length();
}

void RayTracer::set_length() {
    max_distance_ = speed_of_sound(options_.air) * options_.length;
    bins_per_metre_ = 1.0 / (speed_of_sound(options_.air) * options_.bin);
    bins_ = static_cast<std::size_t>(std::ceil(options_.length / options_.bin));
    limit_roulette();
    if (options_.report_materials) {
        describe_intervals();
    }
}

// Sound after a scattering comes from many places: its energy density varies less from place to
// place than that of mirror images, and its T30 in a hall needs more rays than anything else. So a
// larger ball counts it in large spaces (6 % of the edge of a cube as large).
double RayTracer::scattered_radius() const {
    constexpr double kShareOfEdge = 0.06;
    constexpr double kMaxRadius = 1.5;
    Vec3 low(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    for (const Vec3& position : scene_.mesh().positions) {
        low = glm::min(low, position);
        high = glm::max(high, position);
    }
    const Vec3 extent = high - low;
    const double volume = extent.x * extent.y * extent.z;
    if (!(volume > 0.0 && std::isfinite(volume))) {
        return options_.receiver_radius;
    }
    const double edge = math::pow10(math::log10(volume) / 3.0);
    return std::max(options_.receiver_radius, std::min(kShareOfEdge * edge, kMaxRadius));
}

// Two balls, and what part of them is visible from their centre.
Receiver RayTracer::describe_receiver(const Vec3& position) const {
    const std::array<double, 2> radii = {options_.receiver_radius, scattered_radius_};
    const auto is_in_room = [&](const Vec3& point) {
        return rectangular_room_ && rectangular_room_->contains(point);
    };
    const bool sees_every_image = is_in_room(position) && is_in_room(source_.pose.position);
    Receiver receiver{.position = position};
    // From the position alone, so that what it receives depends on no other receiver.
    std::uint64_t bits = options_.seed;
    for (const double coordinate : {position.x, position.y, position.z}) {
        bits = random_bits(bits, kFirstRainStream, std::bit_cast<std::uint64_t>(coordinate));
    }
    receiver.rain_offset = random(bits, kFirstRainStream, 0);
    const std::array<ReceiverBall*, 2> balls = {&receiver.ball, &receiver.scattered_ball};
    for (std::size_t i = 0; i < balls.size(); ++i) {
        const double r = radii[i];
        *balls[i] = {.radius_squared = r * r, .inverse_volume = 0.75 / (math::kPi * r * r * r)};
    }
    // Exact paths of that order leave no image to test.
    if (!sees_every_image && options_.specular_order < kMaxTestedReflections) {
        receiver.ball_points = draw_ball_points(position);
    }
    if (!scene_.bvh.closest_point(position, std::max(scattered_radius_, kNearDistance))) {
        return receiver;
    }
    std::vector<Vec3> directions;
    std::vector<Ray> probes;
    for (std::size_t i = 0; i < kProbeDirections; ++i) {
        directions.push_back(probe_direction(i));
        probes.push_back({position, directions.back()});
    }
    const auto hits = scene_.bvh.closest_hits(probes);
    for (std::size_t i = 0; i < balls.size(); ++i) {
        double cubes = 0.0;
        for (const auto& hit : hits) {
            const double visible = hit ? std::min(hit->t, radii[i]) : radii[i];
            cubes += visible * visible * visible;
        }
        balls[i]->inverse_volume =
            cubes > 0.0 ? kProbeDirections / (4.0 / 3.0 * math::kPi * cubes) : 0.0;
    }
    const std::vector<NearScattering> places = find_near_scattering(position, directions, hits, 0);
    for (const NearScattering& place : places) {
        receiver.near_scattering += place.share / static_cast<double>(places.size());
    }
    receiver.near_scattering = std::min(receiver.near_scattering, 1.0);
    return receiver;
}

void RayTracer::describe_receivers(std::span<const Vec3> listeners, Executor& executor) {
    receivers_.resize(listeners.size());
    executor.for_each(listeners.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
            receivers_[k] = describe_receiver(listeners[k]);
        }
    });
    std::vector<ReceiverTree::Ball> balls;
    for (const Receiver& receiver : receivers_) {
        balls.push_back({receiver.position, std::max(options_.receiver_radius, scattered_radius_)});
    }
    receiver_tree_ = ReceiverTree(balls);
    if (std::any_of(receivers_.begin(), receivers_.end(), [](const Receiver& receiver) {
            return receiver.near_scattering > 0.0;
        })) {
        describe_source();
    }
}

// The source as the receiver of reversed rays.
void RayTracer::describe_source() {
    source_receiver_ = describe_receiver(source_.pose.position);
    if (source_receiver_.near_scattering > 0.0) {
        source_field_.emplace(scene_.bvh,
                              scene_.material_of_triangle,
                              surfaces_,
                              source_.pose.position,
                              self_intersection_offset_);
    }
}

// A ray is faint only compared with the sound that arrives at the same time.
void RayTracer::limit_roulette() {
    constexpr std::size_t kSteps = 256;
    constexpr double kMinThreshold = 1e-7;
    // Where this begins costs a third of the time less than kMinThreshold alone, and leaves the
    // spread of the results as it is.
    constexpr double kShareOfMeanDecay = 0.1;
    roulette_steps_per_metre_ = kSteps / max_distance_;
    roulette_thresholds_.clear();
    for (std::size_t step = 0; step <= kSteps; ++step) {
        const double time = options_.length * static_cast<double>(step) / kSteps;
        const double decayed =
            options_.decay_time > 0.0 ? math::pow10(-6.0 * time / options_.decay_time) : 0.0;
        roulette_thresholds_.push_back(std::max(kMinThreshold, kShareOfMeanDecay * decayed));
    }
}

void RayTracer::describe_surfaces() {
    for (const Material& material : scene_.materials) {
        const RaySurface surface = ray_surface(material, options_.bands, options_.transmission);
        surfaces_.push_back(surface);
        surfaces_.push_back(material.one_sided ? perfect_absorber() : surface);
        reversed_surfaces_.push_back(material.one_sided ? without_transmission(surface) : surface);
        reversed_surfaces_.push_back(material.one_sided ? transmission_alone(surface) : surface);
    }
}

void RayTracer::describe_triangles() {
    triangle_surfaces_.reserve(scene_.mesh().triangles.size());
    for (std::size_t i = 0; i < scene_.mesh().triangles.size(); ++i) {
        const auto [a, b, c] = scene_.bvh.corners(static_cast<TriangleId>(i));
        triangle_surfaces_.push_back({.normal = glm::normalize(glm::cross(b - a, c - a)),
                                      .front = 2 * scene_.material_of_triangle[i]});
    }
}

std::size_t RayTracer::direction_intervals() const noexcept {
    return chunk_count(bins_, audio::kBinsPerSpan);
}

}  // namespace earshot::propagation
