// SPDX-License-Identifier: MIT
#pragma once

// A box and listeners near its surfaces, the energies of its images, and what is read from
// histograms.

#include "earshot/propagation/late_rays.h"

#include <glm/geometric.hpp>

#include "one_material_scene.h"
#include "support/decay_line.h"
#include <cmath>
#include <string>
#include <vector>

namespace earshot::propagation {

inline constexpr double kPi = 3.141592653589793;
inline constexpr double kSpeed = 343.2;
inline constexpr std::size_t kBand = 5;  // 1 kHz
inline constexpr double kBin = 0.05;     // seconds

inline const geometry::Vec3 kRoom = {8.0, 3.5, 6.0};
inline const geometry::Vec3 kSource = {2.0, 1.5, 1.3};

struct Place {
    std::string name;
    geometry::Vec3 position;
};

/// Ever nearer to the ceiling, to an edge and to a corner.
inline std::vector<Place> places(const std::vector<double>& distances) {
    std::vector<Place> result;
    for (const double h : distances) {
        const std::string text = " at " + std::to_string(h);
        result.push_back({"wall" + text, {5.5, 3.5 - h, 4.0}});
        result.push_back({"edge" + text, {5.5, 3.5 - h, 6.0 - h}});
        result.push_back({"corner" + text, {8.0 - h, 3.5 - h, 6.0 - h}});
    }
    return result;
}

inline std::vector<geometry::Vec3> positions(const std::vector<Place>& places) {
    std::vector<geometry::Vec3> result;
    for (const Place& place : places) {
        result.push_back(place.position);
    }
    return result;
}

/// Energies of the images of kRoom from order `min_order` on, interval after interval.
inline std::vector<double> image_energies(const geometry::Vec3& source,
                                          const geometry::Vec3& listener,
                                          double reflected,
                                          int min_order,
                                          double length,
                                          double bin) {
    std::vector<double> energies(static_cast<std::size_t>(std::lround(length / bin)));
    glm::ivec3 most;
    for (int axis = 0; axis < 3; ++axis) {
        most[axis] = static_cast<int>(kSpeed * length / kRoom[axis]) + 2;
    }
    for (int x = -most.x; x <= most.x; ++x) {
        for (int y = -most.y; y <= most.y; ++y) {
            for (int z = -most.z; z <= most.z; ++z) {
                const int n[3] = {x, y, z};
                geometry::Vec3 image;
                for (int k = 0; k < 3; ++k) {
                    image[k] = n[k] * kRoom[k] + (n[k] % 2 == 0 ? source[k] : kRoom[k] - source[k]);
                }
                const double distance = glm::distance(image, listener);
                const int order = std::abs(x) + std::abs(y) + std::abs(z);
                const auto interval = static_cast<std::size_t>(distance / kSpeed / bin);
                if (order >= min_order && interval < energies.size()) {
                    energies[interval] += std::pow(reflected, order) / (distance * distance);
                }
            }
        }
    }
    return energies;
}

inline LateEnergy traced(const OneMaterialScene& scene,
                         const geometry::Vec3& source,
                         const std::vector<geometry::Vec3>& listeners,
                         std::size_t rays,
                         int order,
                         double length,
                         double bin = kBin) {
    const RayOptions options = {.rays = rays,
                                .length = length,
                                .bin = bin,
                                .specular_order = order,
                                .air_absorption = false};
    Executor executor(2);
    return trace_late_rays(
        scene.scene(), {.pose = {.position = source}}, listeners, options, executor);
}

inline double sum_of(const audio::EnergyHistogram& histogram) {
    double sum = 0.0;
    for (const audio::Spectrum& energy : histogram.energy) {
        sum += energy[kBand];
    }
    return sum;
}

inline std::vector<double> energies_of(const audio::EnergyHistogram& histogram) {
    std::vector<double> energies;
    for (const audio::Spectrum& energy : histogram.energy) {
        energies.push_back(energy[kBand]);
    }
    return energies;
}

/// Energy after 200 ms.
inline double late_energy(const std::vector<double>& energies, double bin) {
    double sum = 0.0;
    for (auto n = static_cast<std::size_t>(std::lround(0.2 / bin)); n < energies.size(); ++n) {
        sum += energies[n];
    }
    return sum;
}

/// Reverberation time from a line through the backward integral from -5 to -35 dB.
inline double decay_time(std::vector<double> energies, double bin) {
    for (std::size_t n = energies.size() - 1; n-- > 0;) {
        energies[n] += energies[n + 1];
    }
    return support::line_time(energies, bin, 5.0, 35.0);
}

/// A plane at y = 0 through which sound may pass, 60 m wide.
inline geometry::Mesh wide_plane() {
    geometry::Mesh plane;
    plane.positions = {{-30, 0, -30}, {-30, 0, 30}, {30, 0, 30}, {30, 0, -30}};
    plane.triangles = {{0, 1, 2}, {0, 2, 3}};
    return plane;
}

}  // namespace earshot::propagation
