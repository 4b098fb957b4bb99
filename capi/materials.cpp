// SPDX-License-Identifier: MIT
// Acoustic data of a scene's materials, and the library.
#include "earshot/base/spelling.h"
#include "earshot/capi/internal/bands.h"
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/scene_object.h"
#include "earshot/io/material_assignments.h"

#include <algorithm>
#include <fnmatch.h>
#include <string>

namespace earshot::capi {
namespace {

using propagation::EnergyCoefficient;
using propagation::Material;

constexpr double kDefaultCoefficient = 0.1;  // of materials without data, as readers take it

EnergyCoefficient coefficient_of(const es_material& material,
                                 const double* values,
                                 double otherwise,
                                 const char* argument) {
    if (values == nullptr) {
        return EnergyCoefficient(otherwise);
    }
    if (material.frequency_count == 0) {
        require_in(*values, 0.0, 1.0, argument);
        return EnergyCoefficient(*values);
    }
    std::vector<EnergyCoefficient::Point> points;
    for (std::size_t i = 0; i < material.frequency_count; ++i) {
        require_in(values[i], 0.0, 1.0, argument);
        points.push_back({.frequency_hz = material.frequencies[i], .value = values[i]});
    }
    return EnergyCoefficient(std::move(points));
}

Material material_of(const es_material* given) {
    const es_material material =
        require_struct(require(given, "material"), es_material{}, sizeof(es_material), "material");
    constexpr std::size_t kMaxFrequencies = 10000;
    require_count(material.frequency_count, 0, kMaxFrequencies, "material->frequency_count");
    require_finite(
        require_array(material.frequencies, material.frequency_count, "material->frequencies"),
        "material->frequencies");
    require_flag(material.one_sided, "material->one_sided");
    Material result;
    result.absorption =
        coefficient_of(material, material.absorption, kDefaultCoefficient, "material->absorption");
    result.scattering =
        coefficient_of(material, material.scattering, kDefaultCoefficient, "material->scattering");
    result.transmission =
        coefficient_of(material, material.transmission, 0.0, "material->transmission");
    result.one_sided = material.one_sided != 0;
    propagation::validate(result);
    return result;
}

void assign(SceneObject& object,
            const std::string& pattern,
            Material material,
            const char* function,
            std::size_t* matches) {
    if (matches != nullptr) {
        const auto& materials = object.loaded.scene.materials;
        *matches = static_cast<std::size_t>(
            std::count_if(materials.begin(), materials.end(), [&](const Material& old) {
                return fnmatch(pattern.c_str(), old.name.c_str(), 0) == 0;
            }));
    }
    io::assign_materials({{pattern, std::move(material), function}}, object.loaded);
}

/// The library's material of that name.
Material library_material(const std::string& name) {
    auto row = propagation::find_library_material(name);
    if (!row) {
        std::vector<std::string> names;
        for (const propagation::LibraryMaterial& known : propagation::material_library()) {
            names.emplace_back(known.name);
        }
        constexpr std::size_t kMaxLength = 100;  // no name of the library is near a longer one
        throw Error(name,
                    "the library has no such material",
                    name.size() > kMaxLength
                        ? "es_library_get() tells the names"
                        : did_you_mean(name, names, "es_library_get() tells the names"));
    }
    return std::move(*row);
}

void give_coefficients(const Material& material,
                       std::int32_t coefficient,
                       std::int32_t bands,
                       double* values,
                       std::size_t band_count) {
    require_in(std::int64_t{coefficient}, ES_ABSORPTION, ES_TRANSMISSION, "coefficient");
    const audio::Bands& of = bands_of(bands, "bands");
    require_size(band_count, of.count(), "band_count");
    const auto out = require_array(values, band_count, "values");
    const EnergyCoefficient& chosen = coefficient == ES_ABSORPTION   ? material.absorption
                                      : coefficient == ES_SCATTERING ? material.scattering
                                                                     : material.transmission;
    const audio::Spectrum spectrum = chosen.over(of);
    std::copy_n(spectrum.begin(), out.size(), out.begin());
}

}  // namespace

const audio::Bands& bands_of(std::int32_t bands, const char* argument) {
    require_in(std::int64_t{bands}, ES_BANDS_OCTAVE, ES_BANDS_THIRD, argument);
    return bands == ES_BANDS_THIRD ? audio::Bands::third_octaves() : audio::Bands::octaves();
}

}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_material_init(es_material* material, size_t size) {
    return call(__func__, [&] { init_struct(es_material{}, material, size, sizeof(es_material)); });
}

es_status es_scene_assign(es_scene scene,
                          const char* pattern,
                          const es_material* material,
                          size_t* matches) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        assign(*object,
               std::string(require_text(pattern, "pattern")),
               material_of(material),
               "es_scene_assign",
               matches);
    });
}

es_status es_scene_assign_library(es_scene scene,
                                  const char* pattern,
                                  const char* library_name,
                                  size_t* matches) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        const std::string of(require_text(pattern, "pattern"));
        const std::string name(require_text(library_name, "library_name"));
        assign(*object, of, library_material(name), "es_scene_assign_library", matches);
    });
}

es_status es_scene_assign_file(es_scene scene, const char* file) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        const std::string path(require_text(file, "file"));
        Warnings warnings;
        const auto assignments = io::read_material_assignments(path, warnings);
        Warnings& acoustic = object->loaded.acoustic_warnings;
        acoustic.insert(acoustic.end(), warnings.begin(), warnings.end());
        io::assign_materials(assignments, object->loaded);
    });
}

es_status es_scene_set_material(es_scene scene, size_t index, const es_material* material) {
    return call(__func__, [&] {
        const Changing<SceneObject> object(scene, "scene");
        std::vector<propagation::Material>& materials = object->loaded.scene.materials;
        require_index(index, materials.size(), "index");
        propagation::Material data = material_of(material);
        data.name = materials[index].name;
        materials[index] = std::move(data);
        std::erase(object->loaded.default_materials, static_cast<std::uint32_t>(index));
        std::erase(object->loaded.materials_by_name, static_cast<std::uint32_t>(index));
    });
}

es_status es_bands_nominal(int32_t bands, const double** nominal_hz, size_t* count) {
    return call(__func__, [&] {
        const audio::Bands& of = bands_of(bands, "bands");
        require(nominal_hz, "nominal_hz");
        require(count, "count") = of.count();
        *nominal_hz = of.nominal_hz().data();
    });
}

es_status es_scene_coefficients(es_scene scene,
                                size_t material,
                                int32_t coefficient,
                                int32_t bands,
                                double* values,
                                size_t band_count) {
    return call(__func__, [&] {
        const Reading<SceneObject> object(scene, "scene");
        const auto& materials = object->loaded.scene.materials;
        require_index(material, materials.size(), "material");
        give_coefficients(materials[material], coefficient, bands, values, band_count);
    });
}

size_t es_library_count(void) {
    return propagation::material_library().size();
}

es_status es_library_get(size_t index,
                         const char** name,
                         const char** description,
                         const char** source) {
    return call(__func__, [&] {
        const auto library = propagation::material_library();
        require_index(index, library.size(), "index");
        const auto give = [](std::string_view text, const char** out) {
            if (out != nullptr) {
                *out = text.data();  // a literal, which ends with a zero
            }
        };
        give(library[index].name, name);
        give(library[index].description, description);
        give(library[index].source, source);
    });
}

es_status es_library_coefficients(
    size_t index, int32_t coefficient, int32_t bands, double* values, size_t band_count) {
    return call(__func__, [&] {
        const auto library = propagation::material_library();
        require_index(index, library.size(), "index");
        give_coefficients(library[index].material, coefficient, bands, values, band_count);
    });
}
