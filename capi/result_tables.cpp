// SPDX-License-Identifier: MIT
// What a simulation found, as flat arrays.
#include "earshot/capi/internal/result_object.h"

#include <algorithm>
#include <utility>

namespace earshot::capi {
namespace {

es_path_kind kind_of(propagation::PathKind kind) {
    switch (kind) {
        case propagation::PathKind::specular:
            return ES_PATH_SPECULAR;
        case propagation::PathKind::transmitted:
            return ES_PATH_TRANSMITTED;
        case propagation::PathKind::diffracted:
            return ES_PATH_DIFFRACTED;
        default:
            return ES_PATH_DIRECT;
    }
}

void copy_vector(const geometry::Vec3& from, double (&to)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
        to[axis] = from[axis];
    }
}

/// (bins, bands) of spectra that have room for more bands.
std::vector<double> packed(const std::vector<audio::Spectrum>& spectra, std::size_t bands) {
    std::vector<double> values;
    values.reserve(spectra.size() * bands);
    for (const audio::Spectrum& spectrum : spectra) {
        values.insert(
            values.end(), spectrum.begin(), spectrum.begin() + static_cast<std::ptrdiff_t>(bands));
    }
    return values;
}

}  // namespace

void ResultObject::flatten_paths() {
    for (const propagation::PairResult& pair : pairs) {
        first_path.push_back(paths.size());
        for (const propagation::Path& path : pair.paths) {
            es_path record = {.source = static_cast<std::uint32_t>(pair.source),
                              .listener = static_cast<std::uint32_t>(pair.listener),
                              .kind = kind_of(path.kind),
                              .order = static_cast<std::uint32_t>(path.order),
                              .length = path.length,
                              .delay = path.delay,
                              .departure = {},
                              .arrival = {},
                              .first_point = points.size() / 3,
                              .first_interaction = triangles.size()};
            copy_vector(path.departure, record.departure);
            copy_vector(path.arrival, record.arrival);
            paths.push_back(record);
            for (const geometry::Vec3& point : path.points) {
                points.insert(points.end(), {point.x, point.y, point.z});
            }
            triangles.insert(triangles.end(), path.triangles.begin(), path.triangles.end());
            materials.insert(materials.end(), path.materials.begin(), path.materials.end());
            pressure.insert(pressure.end(),
                            path.pressure.begin(),
                            path.pressure.begin() + static_cast<std::ptrdiff_t>(info.bands));
            first_edge.push_back(edges.size() / 6);
            for (const std::array<geometry::Vec3, 2>& edge : path.edges) {
                for (const geometry::Vec3& end : edge) {
                    edges.insert(edges.end(), {end.x, end.y, end.z});
                }
            }
        }
    }
    first_path.push_back(paths.size());
    first_edge.push_back(edges.size() / 6);
    info.paths = paths.size();
}

void ResultObject::flatten_histograms() {
    for (const propagation::PairResult& pair : pairs) {
        histograms.push_back({.energy = packed(pair.late.energy, info.bands),
                              .error = packed(pair.late.error, info.bands)});
    }
}

void ResultObject::finish() {
    flatten_paths();
    if (has_histograms) {
        flatten_histograms();
    }
    flatten_metrics(*this);
    flatten_sensitivity();
}

}  // namespace earshot::capi
