// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/diffracted_sound.h"

#include "earshot/base/math.h"
#include "earshot/geometry/overlap.h"
#include "earshot/geometry/vector.h"
#include "earshot/propagation/diffraction.h"
#include "earshot/propagation/internal/complex_math.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace earshot::propagation {

using audio::Arrival;
using audio::Spectrum;
using geometry::FacetId;
using geometry::TriangleId;
using geometry::Vec3;
using geometry::Wedge;

namespace {

constexpr std::size_t kKinds = 3;

double wave_number(const DiffractionModel& model, std::size_t band) {
    return 2.0 * math::kPi * model.bands.exact_hz()[band] / model.speed_of_sound;
}

/// The reflections of a path that kind of term mends.
FacetSequence mended_sequence(const frustum::EdgePath& way, const Wedge& wedge, std::size_t kind) {
    FacetSequence sequence = way.before;
    if (kind > 0) {
        sequence.push_back(wedge.faces[kind - 1].facet);
    }
    sequence.insert(sequence.end(), way.after.begin(), way.after.end());
    return sequence;
}

/// Everything on the way but the edge.
Spectrum factors_beside_edge(const frustum::EdgePath& way, const DiffractionModel& model) {
    Spectrum factors{};
    std::fill_n(factors.begin(), model.bands.count(), 1.0);
    const auto multiply = [&](std::span<const double> by) {
        for (std::size_t band = 0; band < model.bands.count(); ++band) {
            factors[band] *= by[band];
        }
    };
    for (const FacetSequence* sequence : {&way.before, &way.after}) {
        for (const FacetId facet : *sequence) {
            multiply(model.reflection[facet]);
        }
    }
    if (model.air_absorption) {
        multiply(model.air.pressures(std::array{way.length}));
    }
    return factors;
}

}  // namespace

TriangleId triangle_at(const frustum::SceneView& scene,
                       const Vec3& point,
                       std::span<const FacetId> facets) {
    TriangleId lowest = scene.facets.facets[facets.front()].triangles.front();
    bool has_one = false;
    constexpr double kTolerances = 4.0;  // as far as outlines may be off
    double reach = kTolerances * scene.facets.tolerance;
    for (const FacetId facet : facets) {
        reach = std::max(
            reach, kTolerances * scene.facets.tolerance + scene.facets.facets[facet].deviation);
    }
    for (const TriangleId triangle : scene.bvh.overlapping(geometry::SphereRegion(point, reach))) {
        const FacetId facet = scene.facets.of_triangle[triangle];
        if (!has_one && std::find(facets.begin(), facets.end(), facet) != facets.end()) {
            lowest = triangle;
            has_one = true;
        }
    }
    return lowest;
}

namespace {

/// A sound before its bands are evaluated.
struct SoundBuilder {
    const Wedge& wedge;
    const DiffractionModel& model;
    Spectrum factors{};  // beside the edge
    EdgeDiffraction edge{};
    DiffractedSound sound{};
    std::optional<EdgeSpectrum> spectrum{};

    double face_factor(std::size_t kind, std::size_t band) const {
        return kind == 0 ? 1.0 : model.reflection[wedge.faces[kind - 1].facet][band];
    }
    bool may_reach(double min_pressure) const;
    double evaluate(std::size_t band);
    bool evaluate(double min_pressure);
};

// A bound that holds for every band, with the loudest factor of each kind.
bool SoundBuilder::may_reach(double min_pressure) const {
    EdgeDiffraction loudest = edge;
    double factor = 0.0;
    for (std::size_t band = 0; band < model.bands.count(); ++band) {
        factor = std::max(factor, factors[band]);
    }
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        double of_face = 0.0;
        for (std::size_t band = 0; sound.is_counted[kind] && band < model.bands.count(); ++band) {
            of_face = std::max(of_face, face_factor(kind, band));
        }
        loudest.pressure_factors[kind] = of_face;
    }
    return factor * max_diffracted_pressure(loudest) >= min_pressure;
}

/// Returns the absolute value of the sum.
double SoundBuilder::evaluate(std::size_t band) {
    const DiffractedPressure found = spectrum->pressure(wave_number(model, band));
    Complex upright{0.0}, inverted{0.0}, net{0.0};
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        if (!sound.is_counted[kind]) {
            continue;
        }
        const double factor = factors[band] * face_factor(kind, band);
        sound.pressure[kind][band] = factor * (found.upright[kind] + found.inverted[kind]);
        upright += factor * found.upright[kind];
        inverted += factor * found.inverted[kind];
        net += sound.pressure[kind][band];
    }
    sound.upright[band] = std::sqrt(std::norm(upright));
    sound.inverted[band] = std::sqrt(std::norm(inverted));
    return std::sqrt(std::norm(net));
}

// Most sounds that are too faint are told by their bound, most others by one of the low bands.
bool SoundBuilder::evaluate(double min_pressure) {
    constexpr double kRoundedDown = 1.0 - 0x1p-10;  // for what is still to be multiplied
    if (!may_reach(kRoundedDown * min_pressure)) {
        return false;
    }
    spectrum.emplace(edge);
    bool is_loud = min_pressure <= 0.0;
    std::size_t band = 0;
    for (; band < model.bands.count() && !is_loud; ++band) {
        is_loud = evaluate(band) >= kRoundedDown * min_pressure;
    }
    for (; band < model.bands.count(); ++band) {
        evaluate(band);
    }
    return is_loud;
}

}  // namespace

std::optional<DiffractedSound> diffracted_sound(frustum::EdgePath way,
                                                const frustum::SceneView& scene,
                                                std::span<const Wedge> wedges,
                                                const SpecularPaths& specular,
                                                const DiffractionModel& model,
                                                double min_pressure) {
    const Wedge& wedge = wedges[way.wedge];
    SoundBuilder builder{.wedge = wedge, .model = model};
    builder.factors = factors_beside_edge(way, model);
    EdgeDiffraction& edge = builder.edge;
    edge.open_angle = wedge.open_angle;
    edge.source = geometry::wedge_coordinates(wedge, way.source_image);
    edge.listener = geometry::wedge_coordinates(wedge, way.listener_image);
    edge.z_begin = way.part.min;
    edge.z_end = way.part.max;
    DiffractedSound& sound = builder.sound;
    const std::size_t reflections = way.before.size() + way.after.size();
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
        sound.mended[kind] = mended_sequence(way, wedge, kind);
        sound.is_counted[kind] =
            reflections + (kind > 0 ? 1 : 0) <= static_cast<std::size_t>(model.max_order);
        // One decision for the path and for the sign of the term.
        edge.sides[kind] =
            specular.count(sound.mended[kind]) != 0 ? ZoneSide::lit : ZoneSide::shadow;
        const Vec3 image =
            kind == 0
                ? way.source_image
                : scene.facets.facets[wedge.faces[kind - 1].facet].plane.mirror(way.source_image);
        sound.mended_length[kind] = glm::distance(image, way.listener_image);
        sound.pressure[kind].resize(model.bands.count());
    }
    if (!builder.evaluate(min_pressure)) {
        return std::nullopt;
    }
    sound.way = std::move(way);
    return std::move(sound);
}

void radiate(const Spectrum& sent, DiffractedSound& sound) {
    for (auto& of_kind : sound.pressure) {
        multiply(of_kind, sent);
    }
    multiply(sound.upright, sent);
    multiply(sound.inverted, sent);
}

Path describe(const DiffractedSound& sound,
              const frustum::SceneView& scene,
              std::span<const Wedge> wedges,
              const Vec3& source,
              const Vec3& listener,
              const DiffractionModel& model) {
    const frustum::EdgePath& way = sound.way;
    const Wedge& wedge = wedges[way.wedge];
    Path path;
    path.kind = PathKind::diffracted;
    path.length = way.length;
    path.delay = way.length / model.speed_of_sound;
    path.points = frustum::points_of(way, scene, wedges, source, listener);
    path.edges = {{wedge.point_at(way.part.min), wedge.point_at(way.part.max)}};
    std::size_t point = 1;
    const auto add = [&](std::span<const FacetId> facets) {
        path.triangles.push_back(triangle_at(scene, path.points[point++], facets));
    };
    for (const FacetId& facet : way.before) {
        add({&facet, 1});
    }
    add(std::array{wedge.faces[0].facet, wedge.faces[1].facet});
    for (const FacetId& facet : way.after) {
        add({&facet, 1});
    }
    path.order = static_cast<int>(path.triangles.size());
    path.parts = {sound.upright, sound.inverted};
    for (std::size_t band = 0; band < model.bands.count(); ++band) {
        Complex net{0.0};
        for (const auto& of_kind : sound.pressure) {
            net += of_kind[band];
        }
        // A source that radiates with the other sign makes the parts negative.
        const bool is_negative = sound.upright[band] < 0.0 || sound.inverted[band] < 0.0;
        path.pressure[band] = std::copysign(std::sqrt(std::norm(net)), is_negative ? -1.0 : 1.0);
        path.parts[1][band] = -path.parts[1][band];
    }
    path.departure = geometry::direction_between(path.points[0], path.points[1]);
    path.arrival =
        geometry::direction_between(path.points[path.points.size() - 2], path.points.back());
    return path;
}

namespace {

/// How much of a term's pressure is one sound with the path that it mends.
double coherence(const DiffractedSound& sound,
                 std::size_t kind,
                 std::size_t band,
                 const DiffractionModel& model) {
    const double width = model.bands.upper_edge_hz(band) - model.bands.lower_edge_hz(band);
    const double detour = sound.way.length - sound.mended_length[kind];
    const double x = math::kPi * width * std::abs(detour) / model.speed_of_sound;
    return x >= math::kPi ? 0.0 : x < 1e-9 ? 1.0 : math::sin(x) / x;
}

/// A specular path, or the place of one, and the terms that mend it.
struct MendedPath {
    std::vector<Complex> pressure;  // per band
    Arrival arrival;
};

}  // namespace

std::vector<Arrival> energy_arrivals(std::span<const Path> paths,
                                     const SpecularPaths& specular,
                                     std::span<const DiffractedSound> sounds,
                                     const DiffractionModel& model) {
    const std::size_t bands = model.bands.count();
    std::map<FacetSequence, MendedPath> mended;
    std::vector<Arrival> arrivals;
    std::vector<std::uint8_t> is_mended(paths.size(), 0);
    for (const DiffractedSound& sound : sounds) {
        Arrival rest{.delay = sound.way.length / model.speed_of_sound};
        std::vector<Complex> rest_pressure(bands);
        for (std::size_t kind = 0; kind < kKinds; ++kind) {
            if (!sound.is_counted[kind]) {
                continue;
            }
            const auto [place, is_new] = mended.try_emplace(sound.mended[kind]);
            MendedPath& target = place->second;
            if (is_new) {
                target.pressure.resize(bands);
                target.arrival.delay = sound.mended_length[kind] / model.speed_of_sound;
                const auto path = specular.find(sound.mended[kind]);
                if (path != specular.end()) {
                    const Path& of_path = paths[path->second];
                    is_mended[path->second] = 1;
                    target.arrival.delay = of_path.delay;
                    for (std::size_t band = 0; band < bands; ++band) {
                        target.pressure[band] = of_path.pressure[band] *
                                                unit(-wave_number(model, band) * of_path.length);
                    }
                }
            }
            for (std::size_t band = 0; band < bands; ++band) {
                const double c = coherence(sound, kind, band, model);
                target.pressure[band] += c * sound.pressure[kind][band];
                rest_pressure[band] += std::sqrt(1.0 - c * c) * sound.pressure[kind][band];
            }
        }
        for (std::size_t band = 0; band < bands; ++band) {
            rest.pressure[band] = std::sqrt(std::norm(rest_pressure[band]));
        }
        arrivals.push_back(rest);
    }
    for (auto& [sequence, target] : mended) {
        for (std::size_t band = 0; band < bands; ++band) {
            target.arrival.pressure[band] = std::sqrt(std::norm(target.pressure[band]));
        }
        arrivals.push_back(target.arrival);
    }
    for (std::size_t i = 0; i < paths.size(); ++i) {
        if (paths[i].kind != PathKind::diffracted && is_mended[i] == 0) {
            Arrival& arrival = arrivals.emplace_back(Arrival{.delay = paths[i].delay});
            for (std::size_t band = 0; band < bands; ++band) {
                arrival.pressure[band] = std::abs(paths[i].pressure[band]);
            }
        }
    }
    return arrivals;
}

}  // namespace earshot::propagation
