// SPDX-License-Identifier: MIT
#include "earshot/propagation/internal/material_rows.h"
#include "earshot/propagation/material.h"

#include <algorithm>

namespace earshot::propagation {

namespace {

EnergyCoefficient coefficient(const internal::Octaves& values) {
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t octave = 0; octave < values.size(); ++octave) {
        points.push_back({internal::kRowHz[octave], values[octave]});
    }
    return EnergyCoefficient(std::move(points));
}

LibraryMaterial material_of(const internal::MaterialRow& row) {
    Material material;
    material.name = row.name;
    material.absorption = coefficient(row.absorption);
    material.scattering = coefficient(row.scattering.values);
    return {row.name, row.description, row.source, row.scattering.source, std::move(material)};
}

std::vector<LibraryMaterial> make_library() {
    std::vector<LibraryMaterial> library;
    for (const auto group : {internal::masonry_rows(),
                             internal::lightweight_rows(),
                             internal::floor_rows(),
                             internal::textile_rows(),
                             internal::seating_rows(),
                             internal::absorber_rows(),
                             internal::outdoor_rows()}) {
        for (const internal::MaterialRow& row : group) {
            library.push_back(material_of(row));
        }
    }
    std::sort(library.begin(),
              library.end(),
              [](const LibraryMaterial& a, const LibraryMaterial& b) { return a.name < b.name; });
    return library;
}

}  // namespace

std::span<const LibraryMaterial> material_library() {
    static const std::vector<LibraryMaterial> library = make_library();
    return library;
}

std::optional<Material> find_library_material(std::string_view name) {
    const std::span<const LibraryMaterial> library = material_library();
    const auto found = std::lower_bound(
        library.begin(), library.end(), name, [](const LibraryMaterial& row, std::string_view n) {
            return row.name < n;
        });
    if (found == library.end() || found->name != name) {
        return std::nullopt;
    }
    return found->material;
}

}  // namespace earshot::propagation
