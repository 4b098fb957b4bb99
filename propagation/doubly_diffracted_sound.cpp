// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/doubly_diffracted_sound.h"

#include "earshot/geometry/vector.h"
#include "earshot/propagation/diffraction.h"
#include "earshot/propagation/internal/complex_math.h"
#include "earshot/propagation/second_order_diffraction.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::propagation {

using audio::Arrival;
using audio::Spectrum;
using geometry::FacetId;
using geometry::Interval;
using geometry::Vec3;
using geometry::Wedge;

namespace {

constexpr std::size_t kKinds = 3;

/// Of either wedge the face that the ways run along.
using CommonFace = std::optional<std::array<int, 2>>;

/// The kind of term of the face that the ways run along, 0 without one.
std::size_t link_kind(const CommonFace& common_face, std::size_t edge) {
    return common_face ? static_cast<std::size_t>((*common_face)[edge]) + 1 : 0;
}

/// Whether the paths that a pair of terms mends have as few reflections as specular paths may have.
/// A reflection in the common face is that of the way along it, which needs one.
bool is_counted(const frustum::EdgePairPath& way,
                std::size_t first_kind,
                std::size_t second_kind,
                int max_order) {
    int reflections = 0;
    bool is_along_face = false;
    for (const auto& [kind, link] : {std::pair(first_kind, link_kind(way.common_face, 0)),
                                     std::pair(second_kind, link_kind(way.common_face, 1))}) {
        is_along_face = is_along_face || (kind > 0 && kind == link);
        reflections += kind > 0 && kind != link ? 1 : 0;
    }
    return std::max(reflections, is_along_face ? 1 : 0) <= max_order;
}

double reflection_of(const Wedge& wedge,
                     std::size_t kind,
                     std::size_t band,
                     const DiffractionModel& model) {
    return kind == 0 ? 1.0 : model.reflection[wedge.faces[kind - 1].facet][band];
}

/// Along a rigid face sources and images coincide, and half of the sound counts. In general what
/// arrives along the face is 1 + its factor times the free field, at either edge, and counts once.
double link_factor(const CommonFace& common_face,
                   const Wedge& first,
                   std::size_t band,
                   const DiffractionModel& model) {
    if (!common_face) {
        return 1.0;
    }
    const double reflection =
        model.max_order > 0 ? reflection_of(first, link_kind(common_face, 0), band, model) : 0.0;
    return 2.0 / (1.0 + reflection);
}

DoubleDiffraction edges_of(const Wedge& first,
                           const Interval& of_first,
                           const Wedge& second,
                           const Interval& of_second,
                           const CommonFace& common_face) {
    DoubleDiffraction edges;
    edges.first = first;
    edges.second = second;
    edges.first_begin = of_first.min;
    edges.first_end = of_first.max;
    edges.second_begin = of_second.min;
    edges.second_end = of_second.max;
    if (common_face) {
        edges.common_face = DoubleDiffraction::CommonFace{(*common_face)[0], (*common_face)[1]};
    }
    return edges;
}

std::vector<DoubleDiffraction> links_of(const frustum::EdgePairPath& way,
                                        std::span<const Wedge> wedges,
                                        const Vec3& source,
                                        const Vec3& listener) {
    std::vector<DoubleDiffraction> links;
    for (const frustum::EdgeLink& link : way.links) {
        links.push_back(edges_of(
            wedges[way.first], link.first, wedges[way.second], link.second, way.common_face));
        links.back().source = source;
        links.back().listener = listener;
    }
    return links;
}

using KindFactors = std::array<Interval, kKinds>;

/// What the terms at a wedge take in any band.
KindFactors term_factors(const Wedge& wedge, const DiffractionModel& model) {
    KindFactors factors{{{1.0, 1.0}, {0.0, 0.0}, {0.0, 0.0}}};
    for (std::size_t kind = 1; kind < kKinds && model.max_order > 0; ++kind) {
        const Spectrum& of_face = model.reflection[wedge.faces[kind - 1].facet];
        const auto end = of_face.begin() + static_cast<std::ptrdiff_t>(model.bands.count());
        const auto [least, most] = std::minmax_element(of_face.begin(), end);
        factors[kind] = {*least, *most};
    }
    return factors;
}

/// What counts as a sum of products of factors at both edges.
std::vector<TermFactors> counted_factors(const Wedge& first,
                                         const Wedge& second,
                                         const CommonFace& common_face,
                                         const DiffractionModel& model) {
    const TermFactors all{term_factors(first, model), term_factors(second, model)};
    if (model.max_order != 1) {
        return {all};
    }
    // One reflection may lie in a face of either edge, but not both.
    TermFactors without = all, just = all;
    for (std::size_t edge = 0; edge < 2; ++edge) {
        for (std::size_t kind = 0; kind < kKinds; ++kind) {
            const bool reflects = kind > 0 && kind != link_kind(common_face, edge);
            (reflects ? without : just)[edge][kind] = {0.0, 0.0};
        }
    }
    return {{without[0], all[1]}, {just[0], without[1]}};
}

/// Of the free field at the distance of the shortest way: EdgePairSpectrum.
constexpr double kMaxSpectrumError = 1e-5;

/// False if the links of one way together are certain to be fainter in every band than a pressure,
/// of what a source sends that radiates 1. `min_length`: of the ways, metres. `max_halvings`:
/// effort.
bool may_be_as_loud(std::span<const DoubleDiffraction> links,
                    const CommonFace& common_face,
                    const DiffractionModel& model,
                    double min_pressure,
                    double min_length,
                    int max_halvings) {
    const Wedge& first = links.front().first;
    double factor = 0.0;
    for (std::size_t band = 0; band < model.bands.count(); ++band) {
        factor = std::max(factor, link_factor(common_face, first, band, model));
    }
    const double max_error = kMaxSpectrumError * static_cast<double>(links.size()) / min_length;
    const double enough = min_pressure / factor - max_error;
    const std::vector<TermFactors> factors =
        counted_factors(first, links.front().second, common_face, model);
    return max_doubly_diffracted_pressure(links, enough, max_halvings, factors) >= enough;
}

/// A halving costs 3 microseconds, finding the links of a pair some hundred and their pressure
/// milliseconds.
constexpr int kHalvingsBeforeLinks = 16;
constexpr int kHalvingsOfLinks = 200;

double wave_number(const DiffractionModel& model, std::size_t band) {
    return 2.0 * math::kPi * model.bands.exact_hz()[band] / model.speed_of_sound;
}

/// Finds the shortest way over all links.
void set_shortest(std::span<const DoubleDiffraction> links, DoublyDiffractedSound& sound) {
    sound.parts = {sound.way.links.front().first, sound.way.links.front().second};
    for (const DoubleDiffraction& link : links) {
        const DoublePath path = shortest_path(link);
        if (&link == &links.front() || path.length() < sound.length) {
            sound.length = path.length();
            sound.apexes = {link.first.point_at(path.first_z), link.second.point_at(path.second_z)};
        }
        sound.parts[0] = {std::min(sound.parts[0].min, link.first_begin),
                          std::max(sound.parts[0].max, link.first_end)};
        sound.parts[1] = {std::min(sound.parts[1].min, link.second_begin),
                          std::max(sound.parts[1].max, link.second_end)};
    }
}

/// Adds the kinds that are counted, with their factors.
void add_band(std::span<const DoubleDiffraction> links,
              std::span<const EdgePairSpectrum> spectra,
              std::size_t band,
              double factor,
              const DiffractionModel& model,
              DoublyDiffractedSound& sound) {
    Complex upright{0.0}, inverted{0.0};
    for (std::size_t number = 0; number < links.size(); ++number) {
        const DoubleDiffraction& link = links[number];
        const DoublyDiffractedPressure found = spectra[number].pressure(wave_number(model, band));
        for (std::size_t i = 0; i < kKinds; ++i) {
            for (std::size_t k = 0; k < kKinds; ++k) {
                if (is_counted(sound.way, i, k, model.max_order)) {
                    const double of_faces = factor * reflection_of(link.first, i, band, model) *
                                            reflection_of(link.second, k, band, model);
                    sound.pressure[i][k][band] +=
                        of_faces * (found.upright[i][k] + found.inverted[i][k]);
                    upright += of_faces * found.upright[i][k];
                    inverted += of_faces * found.inverted[i][k];
                }
            }
        }
    }
    sound.upright[band] = std::sqrt(std::norm(upright));
    sound.inverted[band] = std::sqrt(std::norm(inverted));
}

double pressure_of(const DoublyDiffractedSound& sound, std::size_t band) {
    Complex net{0.0};
    for (const auto& of_first : sound.pressure) {
        for (const auto& of_kinds : of_first) {
            net += of_kinds[band];
        }
    }
    return std::sqrt(std::norm(net));
}

}  // namespace

bool EdgePairLevelFilter::may_be_wanted(const Wedge& first,
                                        const Interval& of_first,
                                        const Wedge& second,
                                        const Interval& of_second,
                                        const std::optional<std::array<int, 2>>& common_face,
                                        std::size_t listener) const {
    DoubleDiffraction edges = edges_of(first, of_first, second, of_second, common_face);
    edges.source = source_;
    edges.listener = listeners_[listener];
    constexpr double kRoundedUp = 1.0 + 0x1p-20;  // the shortest way is found by iteration
    const auto may_be_as_loud_after = [&](double min_length, int max_halvings) {
        return may_be_as_loud(
            {&edges, 1}, common_face, model_, min_pressure_[listener], min_length, max_halvings);
    };
    if (!may_be_as_loud_after(glm::distance(source_, edges.listener), 0)) {
        return false;
    }
    const double length = shortest_path(edges).length();
    return length <= max_length_ * kRoundedUp && may_be_as_loud_after(length, kHalvingsBeforeLinks);
}

std::optional<DoublyDiffractedSound> doubly_diffracted_sound(const frustum::EdgePairPath& way,
                                                             std::span<const Wedge> wedges,
                                                             const Vec3& source,
                                                             const Vec3& listener,
                                                             const DiffractionModel& model,
                                                             double max_length,
                                                             double min_pressure) {
    DoublyDiffractedSound sound;
    sound.way = way;
    const std::vector<DoubleDiffraction> links = links_of(way, wedges, source, listener);
    set_shortest(links, sound);
    if (sound.length > max_length) {
        return std::nullopt;
    }
    if (!may_be_as_loud(
            links, way.common_face, model, min_pressure, sound.length, kHalvingsOfLinks)) {
        return std::nullopt;
    }
    std::vector<EdgePairSpectrum> spectra;
    for (const DoubleDiffraction& link : links) {
        spectra.emplace_back(link, wave_number(model, model.bands.count() - 1));
    }
    Spectrum factors{};
    std::fill_n(factors.begin(), model.bands.count(), 1.0);
    if (model.air_absorption) {
        const auto air = model.air.pressures(std::array{sound.length});
        std::copy_n(air.begin(), model.bands.count(), factors.begin());
    }
    for (auto& of_first : sound.pressure) {
        for (auto& of_kinds : of_first) {
            of_kinds.resize(model.bands.count());
        }
    }
    for (std::size_t band = 0; band < model.bands.count(); ++band) {
        add_band(links,
                 spectra,
                 band,
                 factors[band] * link_factor(way.common_face, wedges[way.first], band, model),
                 model,
                 sound);
    }
    return sound;
}

void radiate(const Spectrum& sent, DoublyDiffractedSound& sound) {
    for (auto& of_first : sound.pressure) {
        for (auto& of_kinds : of_first) {
            multiply(of_kinds, sent);
        }
    }
    multiply(sound.upright, sent);
    multiply(sound.inverted, sent);
}

Path describe(const DoublyDiffractedSound& sound,
              const frustum::SceneView& scene,
              std::span<const Wedge> wedges,
              const Vec3& source,
              const Vec3& listener,
              const DiffractionModel& model) {
    Path path;
    path.kind = PathKind::diffracted;
    path.order = 2;
    path.length = sound.length;
    path.delay = sound.length / model.speed_of_sound;
    path.points = {source, sound.apexes[0], sound.apexes[1], listener};
    const std::array numbers{sound.way.first, sound.way.second};
    for (std::size_t edge = 0; edge < 2; ++edge) {
        const Wedge& wedge = wedges[numbers[edge]];
        path.edges.push_back(
            {wedge.point_at(sound.parts[edge].min), wedge.point_at(sound.parts[edge].max)});
        path.triangles.push_back(triangle_at(
            scene, sound.apexes[edge], std::array{wedge.faces[0].facet, wedge.faces[1].facet}));
    }
    path.parts = {sound.upright, sound.inverted};
    for (std::size_t band = 0; band < model.bands.count(); ++band) {
        // A source that radiates with the other sign makes the parts negative.
        const bool is_negative = sound.upright[band] < 0.0 || sound.inverted[band] < 0.0;
        path.pressure[band] = std::copysign(pressure_of(sound, band), is_negative ? -1.0 : 1.0);
        path.parts[1][band] = -path.parts[1][band];
    }
    path.departure = geometry::direction_between(source, sound.apexes[0]);
    path.arrival = geometry::direction_between(sound.apexes[1], listener);
    return path;
}

namespace {

/// The first-order way over one edge of a pair with a reflection in a face of the other, or none.
frustum::EdgePath mended_way(const DoublyDiffractedSound& sound,
                             std::size_t edge,
                             std::size_t kind_of_other,
                             const frustum::SceneView& scene,
                             std::span<const Wedge> wedges,
                             const Vec3& source,
                             const Vec3& listener) {
    frustum::EdgePath way;
    way.wedge = edge == 0 ? sound.way.first : sound.way.second;
    way.source_image = source;
    way.listener_image = listener;
    way.part = sound.parts[edge];
    const std::size_t other = 1 - edge;
    if (kind_of_other > 0 && kind_of_other != link_kind(sound.way.common_face, other)) {
        const Wedge& wedge = wedges[other == 0 ? sound.way.first : sound.way.second];
        const FacetId facet = wedge.faces[kind_of_other - 1].facet;
        (edge == 0 ? way.after : way.before).push_back(facet);
        Vec3& image = edge == 0 ? way.listener_image : way.source_image;
        image = scene.facets.facets[facet].plane.mirror(image);
    }
    return way;
}

/// The sound over one edge that has the facets of a way and the length closest to `length`; where
/// there is none its place is added.
DiffractedSound& place_of(frustum::EdgePath way,
                          double length,
                          const frustum::SceneView& scene,
                          std::span<const Wedge> wedges,
                          const SpecularPaths& specular,
                          const DiffractionModel& model,
                          std::vector<DiffractedSound>& sounds) {
    DiffractedSound* closest = nullptr;
    for (DiffractedSound& sound : sounds) {
        if (sound.way.wedge == way.wedge && sound.way.before == way.before &&
            sound.way.after == way.after &&
            (closest == nullptr ||
             std::abs(sound.way.length - length) < std::abs(closest->way.length - length))) {
            closest = &sound;
        }
    }
    if (closest != nullptr) {
        return *closest;
    }
    const Wedge& wedge = wedges[way.wedge];
    EdgeDiffraction edge;
    edge.open_angle = wedge.open_angle;
    edge.source = geometry::wedge_coordinates(wedge, way.source_image);
    edge.listener = geometry::wedge_coordinates(wedge, way.listener_image);
    edge.z_begin = way.part.min;
    edge.z_end = way.part.max;
    way.length = shortest_length(edge);
    DiffractedSound& added =
        sounds.emplace_back(*diffracted_sound(std::move(way), scene, wedges, specular, model));
    for (auto& of_kind : added.pressure) {
        std::fill(of_kind.begin(), of_kind.end(), Complex(0.0));
    }
    return added;
}

/// What the product of two pressures is worth on average over a band.
double coherence(double detour, std::size_t band, const DiffractionModel& model) {
    const double width = model.bands.upper_edge_hz(band) - model.bands.lower_edge_hz(band);
    const double x = math::kPi * width * std::abs(detour) / model.speed_of_sound;
    return x >= math::kPi ? 0.0 : x < 1e-9 ? 1.0 : math::sin(x) / x;
}

/// Shares of a pressure, whose squares add up to 1: that of a sound which arrives as one with the
/// first of two others to the degree c1 and with the second to the degree c2 is all in the one with
/// degree 1.
std::array<double, 3> shares(double c1, double c2) {
    const double s1 = c1 * c1, s2 = c2 * c2;
    const double all = 1.0 - s1 * s2;
    if (all < 1e-12) {
        const double half = std::sqrt(0.5);
        return {half, half, 0.0};
    }
    return {std::sqrt(s1 * (1.0 - s2) / all),
            std::sqrt(s2 * (1.0 - s1) / all),
            std::sqrt((1.0 - s1) * (1.0 - s2) / all)};
}

}  // namespace

std::vector<Arrival> join_mended_sounds(std::span<const DoublyDiffractedSound> sounds,
                                        const frustum::SceneView& scene,
                                        std::span<const Wedge> wedges,
                                        const Vec3& source,
                                        const Vec3& listener,
                                        const SpecularPaths& specular,
                                        const DiffractionModel& model,
                                        std::vector<DiffractedSound>& first_order) {
    std::vector<Arrival> arrivals;
    for (const DoublyDiffractedSound& sound : sounds) {
        std::vector<Complex> rest(model.bands.count());
        for (std::size_t i = 0; i < kKinds; ++i) {
            for (std::size_t k = 0; k < kKinds; ++k) {
                if (!is_counted(sound.way, i, k, model.max_order)) {
                    continue;
                }
                const auto place = [&](std::size_t edge, std::size_t kind) -> DiffractedSound& {
                    return place_of(mended_way(sound, edge, kind, scene, wedges, source, listener),
                                    sound.length,
                                    scene,
                                    wedges,
                                    specular,
                                    model,
                                    first_order);
                };
                const double first_length = place(0, k).way.length;
                DiffractedSound& over_second = place(1, i);
                // Adding a place may have moved the other one.
                DiffractedSound& over_first = place(0, k);
                for (std::size_t band = 0; band < model.bands.count(); ++band) {
                    const Complex& pressure = sound.pressure[i][k][band];
                    const auto [to_first, to_second, own] =
                        shares(coherence(sound.length - first_length, band, model),
                               coherence(sound.length - over_second.way.length, band, model));
                    over_first.pressure[i][band] += to_first * pressure;
                    over_second.pressure[k][band] += to_second * pressure;
                    rest[band] += own * pressure;
                }
            }
        }
        Arrival& arrival =
            arrivals.emplace_back(Arrival{.delay = sound.length / model.speed_of_sound});
        for (std::size_t band = 0; band < model.bands.count(); ++band) {
            arrival.pressure[band] = std::sqrt(std::norm(rest[band]));
        }
    }
    return arrivals;
}

}  // namespace earshot::propagation
