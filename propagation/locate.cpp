// SPDX-License-Identifier: MIT
#include "earshot/propagation/locate.h"

#include "earshot/base/random.h"
#include "earshot/propagation/internal/arrival_fit.h"
#include "earshot/propagation/least_squares.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kKelvinAtZero = 273.15;

// What is reported is rounded far more coarsely than the sums of a fit are: steps per unit.
constexpr double kLengthSteps = 1e4;  // metres
constexpr double kSpeedSteps = 1e3;   // metres per second, kelvin
constexpr double kTimeSteps = 1e7;    // seconds
constexpr double kShareSteps = 1e3;

double rounded(double value, double steps) noexcept {
    return std::isfinite(value) ? std::nearbyint(value * steps) / steps + 0.0 : value;
}

void require(bool is_met, const char* option, const char* remedy) {
    if (!is_met) {
        throw Error(option, "is out of range", remedy);
    }
}

void validate(const LocateOptions& options) {
    const char* const error = "give a number of at least 0, or infinity";
    require(options.source_error >= 0.0, "source_error", error);
    require(options.listener_error >= 0.0, "listener_error", error);
    require(options.temperature_error >= 0.0, "temperature_error", error);
    require(options.latency_error >= 0.0, "latency_error", error);
    require(options.wall_error >= 0.0, "wall_error", error);
    require(options.timing_error > 0.0 && std::isfinite(options.timing_error),
            "timing_error",
            "give seconds above 0");
    require(options.match_window > 0.0, "match_window", "give seconds above 0");
    require(!options.specular_order || *options.specular_order >= 0,
            "specular_order",
            "give 0 or more");
    require(options.max_rounds >= 1, "max_rounds", "give 1 or more");
    validate(options.air);
}

std::string name_of_arrival(std::size_t i) {
    return "arrival " + std::to_string(i + 1);
}

void check_arrivals(const Scene& scene, std::span<const MeasuredArrival> arrivals) {
    std::set<std::string> names(scene.mesh.mesh_names().begin(), scene.mesh.mesh_names().end());
    for (const Material& material : scene.materials) {
        names.insert(material.name);
    }
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        const MeasuredArrival& arrival = arrivals[i];
        if (arrival.source >= scene.sources.size() || arrival.listener >= scene.listeners.size()) {
            throw Error(name_of_arrival(i),
                        "its source or listener is not in the scene",
                        "give indices of the scene's");
        }
        if (!(arrival.time >= 0.0) || !std::isfinite(arrival.time)) {
            throw Error(name_of_arrival(i), "its time is out of range", "give seconds from 0 up");
        }
        for (const std::string& name : arrival.surfaces.value_or(std::vector<std::string>{})) {
            if (!names.contains(name)) {
                throw Error(name_of_arrival(i),
                            "no material and no mesh of the scene is called '" + name + "'",
                            "name those that reflect it, in order");
            }
        }
    }
    if (arrivals.empty()) {
        throw Error(scene.name, "there are no arrivals to locate by", "give one or more");
    }
}

int order_of(std::span<const MeasuredArrival> arrivals, const LocateOptions& options) {
    int order = 0;
    for (const MeasuredArrival& arrival : arrivals) {
        order = std::max(order, arrival.surfaces ? static_cast<int>(arrival.surfaces->size()) : 1);
    }
    return options.specular_order.value_or(order);
}

void check(const Scene& scene,
           std::span<const MeasuredArrival> arrivals,
           const LocateOptions& options) {
    validate(options);
    check_arrivals(scene, arrivals);
}

/// A number of the state and what the fit tells of it, rounded.
LocatedValue value_of(
    const ArrivalFit& fit, std::size_t at, double stated, double value, double steps) {
    if (at == ArrivalParameters::kHeld) {
        return {.stated = stated, .value = stated};
    }
    LocatedValue result{.stated = stated, .value = rounded(value, steps)};
    const ArrivalParameters::Entry& entry = fit.parameters->entries()[at];
    const double error = fit.solution.information.standard_errors[at];
    result.standard_error = rounded(entry.scale * error, 10.0 * steps);
    result.data_share = entry.has_prior ? rounded(std::max(0.0, 1.0 - error * error), kShareSteps)
                        : std::isfinite(error) ? 1.0
                                               : 0.0;
    return result;
}

template <typename PlaceOf>
std::vector<LocatedPoint> points_of(const ArrivalFit& fit,
                                    const std::vector<Vec3>& stated,
                                    const std::vector<Vec3>& located,
                                    const PlaceOf& place_of) {
    std::vector<LocatedPoint> points(stated.size());
    for (std::size_t i = 0; i < stated.size(); ++i) {
        const auto value = [&](int axis) {
            return value_of(
                fit, place_of(i, axis), stated[i][axis], located[i][axis], kLengthSteps);
        };
        points[i].x = value(0);
        points[i].y = value(1);
        points[i].z = value(2);
    }
    return points;
}

std::vector<LocatedWall> walls_of(const ArrivalFit& fit, std::span<const ReflectingWall> walls) {
    std::vector<std::size_t> arrivals(walls.size(), 0);
    for (const ArrivalTerm& term : fit.terms) {
        for (const std::size_t wall : term.walls) {
            ++arrivals[wall];
        }
    }
    std::vector<LocatedWall> result;
    for (std::size_t i = 0; i < walls.size(); ++i) {
        if (arrivals[i] > 0) {
            const ReflectingWall& wall = walls[i];
            result.push_back({.material = wall.material,
                              .triangle = wall.triangle,
                              .normal = wall.plane.normal,
                              .offset = value_of(fit,
                                                 fit.parameters->wall(i),
                                                 wall.plane.offset,
                                                 wall.plane.offset + fit.at.wall_offsets[i],
                                                 kLengthSteps),
                              .arrivals = arrivals[i]});
        }
    }
    std::sort(result.begin(), result.end(), [](const LocatedWall& a, const LocatedWall& b) {
        return a.triangle < b.triangle;
    });
    return result;
}

void describe_arrivals(const ArrivalFit& fit,
                       std::span<const ReflectingWall> walls,
                       LocateResult& result) {
    std::vector<double> before, after;
    for (std::size_t k = 0; k < fit.terms.size(); ++k) {
        const ArrivalTerm& term = fit.terms[k];
        const double error_before = arrival_time(fit.stated, walls, term) - term.time;
        const double error_after = arrival_time(fit.at, walls, term) - term.time;
        before.push_back(std::abs(error_before));
        after.push_back(std::abs(error_after));
        const std::size_t i = fit.arrival_of_term[k];
        result.arrivals[i] = {.is_matched = true,
                              .triangles = *fit.paths[i],
                              .before = rounded(error_before, kTimeSteps),
                              .after = rounded(error_after, kTimeSteps),
                              .weight = rounded(fit.solution.robust_weights[k], kShareSteps)};
        ++result.sources[term.source].arrivals;
        ++result.listeners[term.listener].arrivals;
    }
    result.matched = fit.terms.size();
    result.median_before = rounded(median(std::move(before)), kTimeSteps);
    result.median_after = rounded(median(std::move(after)), kTimeSteps);
}

double rms_move(const LocateResult& result, const LocateOptions& options) {
    double sum = 0.0, count = 0.0;
    const auto add = [&](const std::vector<LocatedPoint>& points, double error) {
        for (const LocatedPoint& point : points) {
            if (error > 0.0 && std::isfinite(error)) {
                const Vec3 move = (point.position() - point.stated()) / error;
                sum += glm::dot(move, move);
                count += 3.0;
            }
        }
    };
    add(result.sources, options.source_error);
    add(result.listeners, options.listener_error);
    return count > 0.0 ? std::sqrt(sum / count) : 0.0;
}

LocateResult result_of(const Scene& scene,
                       std::size_t arrivals,
                       const ArrivalFit& fit,
                       std::span<const ReflectingWall> walls,
                       const LocateOptions& options) {
    const ArrivalParameters& parameters = *fit.parameters;
    LocateResult result;
    result.sources =
        points_of(fit, fit.stated.sources, fit.at.sources, [&](std::size_t i, int axis) {
            return parameters.source(i, axis);
        });
    result.listeners =
        points_of(fit, fit.stated.listeners, fit.at.listeners, [&](std::size_t i, int axis) {
            return parameters.listener(i, axis);
        });
    result.speed_of_sound =
        value_of(fit, parameters.speed(), fit.stated.speed, fit.at.speed, kSpeedSteps);
    const double ratio = fit.at.speed / fit.stated.speed;
    result.temperature_c = rounded(
        (kKelvinAtZero + options.air.temperature_c) * ratio * ratio - kKelvinAtZero, kSpeedSteps);
    for (std::size_t i = 0; i < scene.sources.size(); ++i) {
        result.latencies.push_back(
            value_of(fit, parameters.latency(i), 0.0, fit.at.latencies[i], kTimeSteps));
    }
    result.walls = walls_of(fit, walls);
    result.arrivals.resize(arrivals);
    describe_arrivals(fit, walls, result);
    result.motions = common_motions(fit, walls, options.timing_error);
    for (CommonMotion& motion : result.motions) {
        motion.data_share = rounded(motion.data_share, kShareSteps);
    }
    result.rms_move = rounded(rms_move(result, options), kShareSteps);
    result.rounds = fit.rounds;
    result.converged = fit.converged;
    return result;
}

/// The part to which each arrival belongs: a permutation of them, dealt out.
std::vector<std::size_t> folds_of(std::size_t arrivals, std::size_t folds, std::uint64_t seed) {
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (std::size_t i = 0; i < arrivals; ++i) {
        order.emplace_back(random_bits(seed, 0, i), i);
    }
    std::sort(order.begin(), order.end());
    std::vector<std::size_t> fold(arrivals);
    for (std::size_t k = 0; k < arrivals; ++k) {
        fold[order[k].second] = k % folds;
    }
    return fold;
}

}  // namespace

LocateResult locate(const Scene& scene,
                    std::span<const MeasuredArrival> arrivals,
                    const LocateOptions& options,
                    Executor& executor,
                    Progress* progress) {
    check(scene, arrivals, options);
    const int order = order_of(arrivals, options);
    ArrivalFitter fitter(scene, options, order, executor);
    const ArrivalFit fit = fitter.fit(arrivals, progress);
    LocateResult result = result_of(scene, arrivals.size(), fit, fitter.walls(), options);
    result.specular_order = order;
    return result;
}

std::vector<std::optional<double>> cross_validate_locate(const Scene& scene,
                                                         std::span<const MeasuredArrival> arrivals,
                                                         std::size_t folds,
                                                         std::uint64_t seed,
                                                         const LocateOptions& options,
                                                         Executor& executor,
                                                         Progress* progress) {
    check(scene, arrivals, options);
    require(folds >= 2 && folds <= arrivals.size(), "folds", "give 2 ... the number of arrivals");
    ArrivalFitter fitter(scene, options, order_of(arrivals, options), executor);
    const std::vector<std::size_t> fold_of = folds_of(arrivals.size(), folds, seed);
    std::vector<std::optional<double>> errors(arrivals.size());
    for (std::size_t fold = 0; fold < folds; ++fold) {
        std::vector<MeasuredArrival> kept, left_out;
        for (std::size_t i = 0; i < arrivals.size(); ++i) {
            (fold_of[i] == fold ? left_out : kept).push_back(arrivals[i]);
        }
        const auto of_fold = fitter.errors_of(fitter.fit(kept, nullptr), left_out);
        std::size_t next = 0;
        for (std::size_t i = 0; i < arrivals.size(); ++i) {
            if (fold_of[i] == fold) {
                const std::optional<double>& error = of_fold[next++];
                errors[i] = error ? std::optional(rounded(*error, kTimeSteps)) : std::nullopt;
            }
        }
        if (progress != nullptr) {
            progress->report("cross-validation", fold + 1, folds);
        }
    }
    return errors;
}

std::optional<double> median_absolute(std::span<const std::optional<double>> errors) {
    std::vector<double> values;
    for (const std::optional<double>& error : errors) {
        if (error) {
            values.push_back(std::abs(*error));
        }
    }
    return values.empty() ? std::nullopt : std::optional(median(std::move(values)));
}

}  // namespace earshot::propagation
