// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/arrival_fit.h"

#include <algorithm>
#include <cmath>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

constexpr double kKelvinAtZero = 273.15;

/// Rounds end when no parameter moves by more than this part of its error.
constexpr double kMaxMove = 1e-4;

/// No room is so large: what moves farther follows no arrival.
constexpr double kMaxDistance = 1e6;  // metres

void check_state(const ArrivalState& state, const ArrivalState& stated) {
    bool is_sensible = state.speed > 0.0 && std::isfinite(state.speed);
    const auto check = [&](const std::vector<Vec3>& points, const std::vector<Vec3>& from) {
        for (std::size_t i = 0; i < points.size(); ++i) {
            // Not >, so that what is no number fails too.
            is_sensible = is_sensible && glm::distance(points[i], from[i]) <= kMaxDistance;
        }
    };
    check(state.sources, stated.sources);
    check(state.listeners, stated.listeners);
    if (!is_sensible) {
        throw Error("arrivals",
                    "lead to no positions: the fit runs away",
                    "state positions and the temperature with finite errors, or name the surfaces");
    }
}

double largest_move(const ArrivalFit& fit, const ArrivalState& before) {
    const std::vector<double> from = fit.parameters->parameters_of(before);
    double largest = 0.0;
    for (std::size_t at = 0; at < from.size(); ++at) {
        largest = std::max(largest, std::abs(fit.solution.parameters[at] - from[at]));
    }
    return largest;
}

}  // namespace

ArrivalFitter::ArrivalFitter(const Scene& scene,
                             const LocateOptions& options,
                             int specular_order,
                             Executor& executor)
    : scene_(scene),
      options_(options),
      specular_order_(specular_order),
      executor_(executor),
      walls_(scene, options.time) {}

ArrivalFit ArrivalFitter::fit(std::span<const MeasuredArrival> arrivals, Progress* progress) {
    ArrivalFit fit;
    for (const Emitter& source : scene_.sources) {
        fit.stated.sources.push_back(scene_.position_at(source, options_.time));
    }
    for (const Emitter& listener : scene_.listeners) {
        fit.stated.listeners.push_back(scene_.position_at(listener, options_.time));
    }
    fit.stated.speed = speed_of_sound(options_.air);
    fit.stated.latencies.assign(scene_.sources.size(), 0.0);
    fit.at = fit.stated;
    const auto max_rounds = static_cast<std::size_t>(options_.max_rounds);
    while (!fit.converged && fit.rounds < options_.max_rounds) {
        const MatchedPaths paths_before = fit.paths;
        find_terms(arrivals, fit, fit.rounds == 0);
        const ArrivalState before = fit.at;
        solve(fit);
        ++fit.rounds;
        fit.converged = fit.solution.converged && fit.paths == paths_before &&
                        largest_move(fit, before) <= kMaxMove;
        if (progress != nullptr) {
            progress->report("locating",
                             fit.converged ? max_rounds : static_cast<std::size_t>(fit.rounds),
                             max_rounds);
        }
    }
    return fit;
}

void ArrivalFitter::find_terms(std::span<const MeasuredArrival> arrivals,
                               ArrivalFit& fit,
                               bool is_first) {
    const auto pairs = paths_at(scene_, fit.at, options_, specular_order_, executor_);
    if (is_first && options_.latency_error > 0.0) {
        fit.at.latencies = first_latencies(scene_, arrivals, pairs, fit.at.speed);
    }
    MatchedPaths paths = match_arrivals(scene_, arrivals, pairs, fit.at, options_.match_window);
    // What was visible from the last positions is not dropped for being hidden from these: its
    // length is that of the mirrored image wherever it is.
    for (std::size_t i = 0; i < arrivals.size() && !is_first; ++i) {
        if (!paths[i] && arrivals[i].surfaces) {
            paths[i] = fit.paths[i];
        }
    }
    fit.paths = std::move(paths);
    fit.terms = terms_of(arrivals, fit.paths, fit.at);
    fit.stated.wall_offsets.resize(fit.at.wall_offsets.size(), 0.0);
    fit.arrival_of_term.clear();
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        if (fit.paths[i]) {
            fit.arrival_of_term.push_back(i);
        }
    }
    if (fit.terms.empty()) {
        throw Error("arrivals",
                    "none of " + std::to_string(arrivals.size()) + " fits a path of the scene",
                    "check the names of surfaces and that times are in seconds, raise the order or "
                    "the window, or let sources have a latency");
    }
}

std::vector<ArrivalTerm> ArrivalFitter::terms_of(std::span<const MeasuredArrival> arrivals,
                                                 const MatchedPaths& paths,
                                                 ArrivalState& state) {
    std::vector<ArrivalTerm> terms;
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        if (paths[i]) {
            ArrivalTerm& term = terms.emplace_back(ArrivalTerm{.source = arrivals[i].source,
                                                               .listener = arrivals[i].listener,
                                                               .time = arrivals[i].time});
            for (const geometry::TriangleId triangle : *paths[i]) {
                term.walls.push_back(walls_.wall_of(triangle));
            }
        }
    }
    state.wall_offsets.resize(walls().size(), 0.0);
    return terms;
}

ArrivalState ArrivalFitter::errors_of_stated(const ArrivalState& stated) const {
    ArrivalState errors;
    errors.sources.assign(stated.sources.size(), Vec3(options_.source_error));
    errors.listeners.assign(stated.listeners.size(), Vec3(options_.listener_error));
    // The speed of sound goes with the square root of the absolute temperature.
    errors.speed = stated.speed * options_.temperature_error /
                   (2.0 * (kKelvinAtZero + options_.air.temperature_c));
    errors.latencies.assign(stated.latencies.size(), options_.latency_error);
    errors.wall_offsets.assign(stated.wall_offsets.size(), options_.wall_error);
    return errors;
}

void ArrivalFitter::solve(ArrivalFit& fit) const {
    fit.parameters.emplace(fit.stated, errors_of_stated(fit.stated));
    const LeastSquaresProblem problem =
        arrival_problem(*fit.parameters, walls(), fit.terms, options_.timing_error);
    fit.solution = solve_least_squares(problem, fit.parameters->parameters_of(fit.at));
    fit.at = fit.parameters->state_at(fit.solution.parameters);
    check_state(fit.at, fit.stated);
}

std::vector<std::optional<double>> ArrivalFitter::errors_of(
    const ArrivalFit& fit, std::span<const MeasuredArrival> arrivals) {
    ArrivalState state = fit.at;
    const auto pairs = paths_at(scene_, state, options_, specular_order_, executor_);
    const MatchedPaths paths =
        match_arrivals(scene_, arrivals, pairs, state, options_.match_window);
    const std::vector<ArrivalTerm> terms = terms_of(arrivals, paths, state);
    std::vector<std::optional<double>> errors(arrivals.size());
    std::size_t term = 0;
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
        if (paths[i]) {
            errors[i] = arrival_time(state, walls(), terms[term]) - terms[term].time;
            ++term;
        }
    }
    return errors;
}

namespace {

/// The parameters' change by a motion of points, with the walls that are not held.
class MotionBuilder {
public:
    MotionBuilder(const ArrivalFit& fit, std::span<const ReflectingWall> walls)
        : fit_(fit), walls_(walls) {
        Vec3 sum(0.0);
        for (const auto* points : {&fit.at.sources, &fit.at.listeners}) {
            for (const Vec3& point : *points) {
                sum += point;
            }
        }
        centroid_ = sum / static_cast<double>(fit.at.sources.size() + fit.at.listeners.size());
    }

    const Vec3& centroid() const noexcept { return centroid_; }

    /// `velocity` of a point; `wall_speed` of a plane along its normal; of the speed of sound.
    template <typename PointVelocity, typename WallSpeed>
    std::vector<double> motion(const PointVelocity& velocity,
                               const WallSpeed& wall_speed,
                               double speed_change) const {
        const ArrivalParameters& parameters = *fit_.parameters;
        std::vector<double> motion(parameters.count(), 0.0);
        const auto set = [&](std::size_t at, double change) {
            if (at != ArrivalParameters::kHeld) {
                motion[at] = change / parameters.entries()[at].scale;
            }
        };
        for (int axis = 0; axis < 3; ++axis) {
            for (std::size_t i = 0; i < fit_.at.sources.size(); ++i) {
                set(parameters.source(i, axis), velocity(fit_.at.sources[i])[axis]);
            }
            for (std::size_t i = 0; i < fit_.at.listeners.size(); ++i) {
                set(parameters.listener(i, axis), velocity(fit_.at.listeners[i])[axis]);
            }
        }
        for (std::size_t i = 0; i < walls_.size() && i < fit_.at.wall_offsets.size(); ++i) {
            const geometry::Plane& plane = walls_[i].plane;
            set(parameters.wall(i),
                wall_speed(geometry::Plane{plane.normal, plane.offset + fit_.at.wall_offsets[i]}));
        }
        set(parameters.speed(), speed_change);
        return motion;
    }

private:
    const ArrivalFit& fit_;
    std::span<const ReflectingWall> walls_;
    Vec3 centroid_{0.0};
};

/// What the data tell of the motion, of all that is told of it: the ratio of the normal matrices'
/// quadratic forms.
double data_share_of(const ArrivalFit& fit,
                     std::span<const double> jacobian,
                     std::span<const double> motion) {
    double data = 0.0, prior = 0.0;
    for (std::size_t i = 0; i < fit.terms.size(); ++i) {
        double change = 0.0;
        for (std::size_t k = 0; k < motion.size(); ++k) {
            change += jacobian[i * motion.size() + k] * motion[k];
        }
        data += fit.solution.robust_weights[i] * change * change;
    }
    for (std::size_t k = 0; k < motion.size(); ++k) {
        prior += fit.parameters->entries()[k].has_prior ? motion[k] * motion[k] : 0.0;
    }
    return data + prior > 0.0 ? data / (data + prior) : 0.0;
}

bool has_held_points(const ArrivalFit& fit) {
    return (!fit.at.sources.empty() && fit.parameters->source(0, 0) == ArrivalParameters::kHeld) ||
           (!fit.at.listeners.empty() &&
            fit.parameters->listener(0, 0) == ArrivalParameters::kHeld);
}

}  // namespace

std::vector<CommonMotion> common_motions(const ArrivalFit& fit,
                                         std::span<const ReflectingWall> walls,
                                         double timing_error) {
    if (has_held_points(fit)) {
        return {};
    }
    const LeastSquaresProblem problem =
        arrival_problem(*fit.parameters, walls, fit.terms, timing_error);
    std::vector<double> residuals(problem.residual_count);
    std::vector<double> jacobian(problem.residual_count * fit.parameters->count());
    problem.evaluate(fit.solution.parameters, residuals, jacobian);
    const MotionBuilder builder(fit, walls);
    std::vector<CommonMotion> motions;
    const auto add = [&](std::string name, const std::vector<double>& motion) {
        motions.push_back({std::move(name), data_share_of(fit, jacobian, motion)});
    };
    const Vec3 centroid = builder.centroid();
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 unit(0.0);
        unit[axis] = 1.0;
        add(std::string("translation ") + "xyz"[axis],
            builder.motion([&](const Vec3&) { return unit; },
                           [&](const geometry::Plane& plane) { return plane.normal[axis]; },
                           0.0));
    }
    for (int axis = 0; axis < 3; ++axis) {
        Vec3 unit(0.0);
        unit[axis] = 1.0;
        add(std::string("rotation ") + "xyz"[axis],
            builder.motion([&](const Vec3& at) { return glm::cross(unit, at - centroid); },
                           [](const geometry::Plane&) { return 0.0; },
                           0.0));
    }
    if (fit.parameters->speed() != ArrivalParameters::kHeld) {
        add("scale",
            builder.motion([&](const Vec3& at) { return at - centroid; },
                           [&](const geometry::Plane& plane) { return -plane.distance(centroid); },
                           fit.at.speed));
    }
    return motions;
}

}  // namespace earshot::propagation
