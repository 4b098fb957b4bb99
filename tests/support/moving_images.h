// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/room_shapes.h"
#include "earshot/propagation/scene.h"

#include <glm/geometric.hpp>

#include <cmath>
#include <cstdlib>
#include <vector>

namespace earshot::test {

/// A source that passes a listener in a box, and the images that the listener hears of it.
struct PassingSource {
    geometry::Vec3 size{40.0, 12.0, 30.0};
    geometry::Vec3 listener{20.0, 2.0, 10.0};
    double speed = 1.0;             ///< metres per second
    double speed_of_sound = 343.2;  ///< likewise

    propagation::Scene scene(double absorption) const {
        propagation::Scene scene = propagation::shoebox_room(size);
        for (propagation::Material& material : scene.materials) {
            material.absorption = propagation::EnergyCoefficient(absorption);
            material.scattering = propagation::EnergyCoefficient(0.0);
        }
        scene.sources = {{.name = "s", .node = -1, .position = {15.0, 2.0, 13.0}}};
        scene.listeners = {{.name = "l", .node = -1, .position = listener}};
        return scene;
    }

    /// Passes the listener at 3 m, 0.5 s after the begin.
    geometry::Vec3 place(double t) const { return {20.0 + speed * (t - 0.5), 2.0, 13.0}; }

    struct Image {
        double emission = 0.0;  ///< seconds
        double pressure = 0.0;  ///< at the listener, re that at 1 m
    };

    /// All images up to an order that are heard at `t`, walls reflecting that share of the
    /// pressure: p(t) = s(t_e) / r(t_e), t_e by bisection of t = t_e + r(t_e) / c.
    std::vector<Image> images(double t, int order, double reflection) const {
        std::vector<Image> all;
        for (int i = -order; i <= order; ++i) {
            for (int j = -order; j <= order; ++j) {
                for (int k = -order; k <= order; ++k) {
                    const int reflections = std::abs(i) + std::abs(j) + std::abs(k);
                    if (reflections > order) {
                        continue;
                    }
                    double low = t - 0.5, high = t;
                    for (int step = 0; step < 60; ++step) {
                        const double middle = 0.5 * (low + high);
                        const bool is_early =
                            middle + distance(middle, i, j, k) / speed_of_sound < t;
                        (is_early ? low : high) = middle;
                    }
                    all.push_back(
                        {.emission = low,
                         .pressure = std::pow(reflection, reflections) / distance(low, i, j, k)});
                }
            }
        }
        return all;
    }

private:
    double distance(double t, int i, int j, int k) const {
        const auto along = [](double length, double x, int n) {
            return n * length + (n % 2 == 0 ? x : length - x);
        };
        const geometry::Vec3 s = place(t);
        return glm::distance(
            geometry::Vec3(along(size.x, s.x, i), along(size.y, s.y, j), along(size.z, s.z, k)),
            listener);
    }
};

}  // namespace earshot::test
