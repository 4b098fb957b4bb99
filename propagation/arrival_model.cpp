// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/arrival_model.h"

#include "earshot/geometry/vector.h"

#include <algorithm>
#include <cmath>

namespace earshot::propagation {

using geometry::Vec3;

double path_length(const ArrivalState& state,
                   std::span<const ReflectingWall> walls,
                   const ArrivalTerm& term,
                   LengthGradient* gradient) {
    Vec3 image = state.sources[term.source];
    for (const std::size_t wall : term.walls) {
        const geometry::Plane& plane = walls[wall].plane;
        const double distance =
            glm::dot(plane.normal, image) - plane.offset - state.wall_offsets[wall];
        image -= 2.0 * distance * plane.normal;
    }
    const Vec3 way = state.listeners[term.listener] - image;
    const double length = std::sqrt(glm::dot(way, way));
    if (gradient != nullptr) {
        // The chain rule from the last image back to the source: a reflection mirrors the
        // derivative too, and moving its plane moves the image twice as far.
        gradient->listener = geometry::normalized_or_zero(way);
        gradient->walls.assign(term.walls.size(), 0.0);
        Vec3 by_image = -gradient->listener;
        for (std::size_t k = term.walls.size(); k-- > 0;) {
            const Vec3& normal = walls[term.walls[k]].plane.normal;
            const double along = glm::dot(normal, by_image);
            gradient->walls[k] = 2.0 * along;
            by_image -= 2.0 * along * normal;
        }
        gradient->source = by_image;
    }
    return length;
}

double arrival_time(const ArrivalState& state,
                    std::span<const ReflectingWall> walls,
                    const ArrivalTerm& term) {
    return path_length(state, walls, term) / state.speed + state.latencies[term.source];
}

ArrivalParameters::ArrivalParameters(const ArrivalState& stated, const ArrivalState& errors)
    : stated_(stated) {
    for (const Vec3& error : errors.sources) {
        for (int axis = 0; axis < 3; ++axis) {
            sources_.push_back(add(error[axis]));
        }
    }
    for (const Vec3& error : errors.listeners) {
        for (int axis = 0; axis < 3; ++axis) {
            listeners_.push_back(add(error[axis]));
        }
    }
    speed_ = add(errors.speed);
    for (const double error : errors.latencies) {
        latencies_.push_back(add(error));
    }
    for (const double error : errors.wall_offsets) {
        walls_.push_back(add(error));
    }
}

std::size_t ArrivalParameters::add(double error) {
    if (error == 0.0) {
        return kHeld;
    }
    entries_.push_back(
        {.scale = std::isfinite(error) ? error : 1.0, .has_prior = std::isfinite(error)});
    return entries_.size() - 1;
}

ArrivalState ArrivalParameters::state_at(std::span<const double> parameters) const {
    ArrivalState state = stated_;
    const auto move = [&](double& number, std::size_t at) {
        if (at != kHeld) {
            number += entries_[at].scale * parameters[at];
        }
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < state.sources.size(); ++i) {
            move(state.sources[i][axis], source(i, axis));
        }
        for (std::size_t i = 0; i < state.listeners.size(); ++i) {
            move(state.listeners[i][axis], listener(i, axis));
        }
    }
    move(state.speed, speed_);
    for (std::size_t i = 0; i < latencies_.size(); ++i) {
        move(state.latencies[i], latencies_[i]);
    }
    for (std::size_t i = 0; i < walls_.size(); ++i) {
        move(state.wall_offsets[i], walls_[i]);
    }
    return state;
}

std::vector<double> ArrivalParameters::parameters_of(const ArrivalState& state) const {
    std::vector<double> parameters(count(), 0.0);
    const auto set = [&](std::size_t at, double number, double stated) {
        if (at != kHeld) {
            parameters[at] = (number - stated) / entries_[at].scale;
        }
    };
    for (int axis = 0; axis < 3; ++axis) {
        for (std::size_t i = 0; i < state.sources.size(); ++i) {
            set(source(i, axis), state.sources[i][axis], stated_.sources[i][axis]);
        }
        for (std::size_t i = 0; i < state.listeners.size(); ++i) {
            set(listener(i, axis), state.listeners[i][axis], stated_.listeners[i][axis]);
        }
    }
    set(speed_, state.speed, stated_.speed);
    for (std::size_t i = 0; i < latencies_.size(); ++i) {
        set(latencies_[i], state.latencies[i], stated_.latencies[i]);
    }
    for (std::size_t i = 0; i < walls_.size(); ++i) {
        set(walls_[i], state.wall_offsets[i], stated_.wall_offsets[i]);
    }
    return parameters;
}

namespace {

/// Adds the derivatives of a term's time to its row, `scale` times.
void add_derivatives(const ArrivalParameters& parameters,
                     const ArrivalState& state,
                     const ArrivalTerm& term,
                     double length,
                     const LengthGradient& gradient,
                     double scale,
                     std::span<double> row) {
    const auto add = [&](std::size_t at, double derivative) {
        if (at != ArrivalParameters::kHeld) {
            row[at] += scale * parameters.entries()[at].scale * derivative;
        }
    };
    for (int axis = 0; axis < 3; ++axis) {
        add(parameters.source(term.source, axis), gradient.source[axis] / state.speed);
        add(parameters.listener(term.listener, axis), gradient.listener[axis] / state.speed);
    }
    add(parameters.speed(), -length / (state.speed * state.speed));
    add(parameters.latency(term.source), 1.0);
    for (std::size_t k = 0; k < term.walls.size(); ++k) {
        add(parameters.wall(term.walls[k]), gradient.walls[k] / state.speed);
    }
}

}  // namespace

LeastSquaresProblem arrival_problem(const ArrivalParameters& parameters,
                                    std::span<const ReflectingWall> walls,
                                    std::span<const ArrivalTerm> terms,
                                    double timing_error) {
    std::vector<std::size_t> priors;
    for (std::size_t at = 0; at < parameters.count(); ++at) {
        if (parameters.entries()[at].has_prior) {
            priors.push_back(at);
        }
    }
    LeastSquaresProblem problem;
    problem.residual_count = terms.size() + priors.size();
    problem.robust_count = terms.size();
    problem.evaluate =
        [&parameters, walls, terms, timing_error, priors = std::move(priors)](
            std::span<const double> x, std::span<double> residuals, std::span<double> jacobian) {
            const ArrivalState state = parameters.state_at(x);
            std::fill(jacobian.begin(), jacobian.end(), 0.0);
            LengthGradient gradient;
            for (std::size_t i = 0; i < terms.size(); ++i) {
                const ArrivalTerm& term = terms[i];
                const double length =
                    path_length(state, walls, term, jacobian.empty() ? nullptr : &gradient);
                const double time = length / state.speed + state.latencies[term.source];
                residuals[i] = (time - term.time) / timing_error;
                if (!jacobian.empty()) {
                    add_derivatives(parameters,
                                    state,
                                    term,
                                    length,
                                    gradient,
                                    1.0 / timing_error,
                                    jacobian.subspan(i * x.size(), x.size()));
                }
            }
            for (std::size_t k = 0; k < priors.size(); ++k) {
                residuals[terms.size() + k] = x[priors[k]];
                if (!jacobian.empty()) {
                    jacobian[(terms.size() + k) * x.size() + priors[k]] = 1.0;
                }
            }
        };
    return problem;
}

}  // namespace earshot::propagation
