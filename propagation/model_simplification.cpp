// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_simplification.h"

#include "earshot/base/error.h"
#include "earshot/bvh/deformable_bvh.h"
#include "earshot/geometry/simplify.h"
#include "earshot/propagation/internal/part_simplifier.h"
#include "earshot/propagation/internal/simplified_materials.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <mutex>
#include <set>
#include <tuple>
#include <utility>

namespace earshot::propagation {
namespace {

using geometry::Triangle;
using geometry::TriangleId;
using geometry::Vec3;
using geometry::VertexId;

constexpr std::uint32_t kNone = 0xffffffffU;

/// One scene being simplified.
class Simplification {
public:
    Simplification(const Scene& scene, const SimplificationOptions& options, Executor& executor)
        : scene_(scene),
          options_(options),
          executor_(executor),
          positions_(scene.mesh.positions_at(0.0)) {
        for (const Emitter& source : scene.sources) {
            points_.push_back(scene.pose_at(source, 0.0).position);
        }
        for (const Emitter& listener : scene.listeners) {
            points_.push_back(scene.pose_at(listener, 0.0).position);
        }
    }

    SimplifiedModel run() {
        simplify_parts();
        sum_up_parts();
        choose_materials();
        build_mesh();
        find_close_emitters();
        return std::move(result_);
    }

private:
    void simplify_parts() {
        std::vector<SurfaceLabel> of_triangle;
        for (TriangleId id = 0; id < scene_.mesh.triangles().size(); ++id) {
            of_triangle.push_back(
                {scene_.mesh.mesh_of_triangle()[id], scene_.material_of_triangle[id]});
        }
        const std::set<SurfaceLabel> sorted(of_triangle.begin(), of_triangle.end());
        labels_.assign(sorted.begin(), sorted.end());
        std::vector<std::uint32_t> label_ids;
        for (const SurfaceLabel& label : of_triangle) {
            label_ids.push_back(static_cast<std::uint32_t>(
                std::lower_bound(labels_.begin(), labels_.end(), label) - labels_.begin()));
        }
        const MeshParts found =
            find_mesh_parts({positions_, scene_.mesh.triangles()}, label_ids, executor_);
        if (found.parts.empty()) {
            throw Error(scene_.name, "has no triangle with an area", "choose another scene");
        }
        SimplificationReport& report = result_.report;
        report.triangles_before = scene_.mesh.triangles().size();
        report.vertices_before = positions_.size();
        report.dropped_triangles = found.dropped;
        report.parts = found.parts.size();
        parts_.resize(found.parts.size());
        const PartSimplifier simplifier(scene_, labels_, points_, options_);
        std::mutex mutex;
        std::size_t done = 0;
        executor_.for_each(parts_.size(), 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                parts_[i] = simplifier.simplify(found.parts[i]);
                const std::lock_guard lock(mutex);
                ++done;
                if (options_.progress != nullptr) {
                    options_.progress->report("simplifying", done, parts_.size());
                }
            }
        });
        for (const MeshPart& part : found.parts) {
            report.solid_volume_before += std::max(0.0, part.volume);
        }
    }

    void sum_up_parts() {
        SimplificationReport& report = result_.report;
        for (const SimplifiedPart& part : parts_) {
            (part.box ? report.boxes : report.surfaces).include(part.change);
            report.parts_tightened += part.is_tightened ? 1 : 0;
            report.parts_kept += part.is_kept ? 1 : 0;
            report.solid_volume_after += std::max(0.0, part.volume);
        }
    }

    /// What a material of the result stands for.
    struct Replacement {
        std::vector<ReplacedSurface> surfaces;
        double area_after = 0.0;
        std::size_t triangles_before = 0;
        std::size_t triangles_after = 0;
    };

    /// A material of the scene for surfaces, another for boxes.
    void choose_materials() {
        const std::size_t count = scene_.materials.size();
        std::vector<Replacement> surfaces(count);
        std::vector<Replacement> boxes(count);
        for (const SimplifiedPart& part : parts_) {
            const std::uint32_t box_material =
                part.box ? labels_[part.labels.front()].material : kNone;
            for (const SimplifiedPart::LabelUse& use : part.uses) {
                const std::uint32_t material = labels_[use.label].material;
                Replacement& replacement = part.box ? boxes[box_material] : surfaces[material];
                replacement.surfaces.push_back({.material = &scene_.materials[material],
                                                .area = use.area_before,
                                                .rms_distance = use.rms_distance});
                replacement.area_after += use.area_after;
                replacement.triangles_before += use.triangles_before;
                replacement.triangles_after += use.triangles_after;
            }
        }
        result_.scene.materials = scene_.materials;
        result_.report.materials.resize(count);
        box_material_.assign(count, kNone);
        for (std::uint32_t m = 0; m < count; ++m) {
            if (!surfaces[m].surfaces.empty()) {
                set_material(m, surfaces[m], scene_.materials[m]);
            }
        }
        for (std::uint32_t m = 0; m < count; ++m) {
            if (boxes[m].surfaces.empty()) {
                continue;
            }
            // Where nothing else has the material, its own name stays.
            const bool is_alone = surfaces[m].surfaces.empty();
            box_material_[m] =
                is_alone ? m : static_cast<std::uint32_t>(result_.scene.materials.size());
            if (!is_alone) {
                result_.scene.materials.emplace_back();
                result_.report.materials.emplace_back();
            }
            Material material = scene_.materials[m];
            if (!is_alone) {
                material.name = name_of_boxes(m);
            }
            set_material(box_material_[m], boxes[m], std::move(material));
        }
    }

    std::string name_of_boxes(std::uint32_t material) const {
        std::string name = scene_.materials[material].name + ", boxes";
        const auto is_taken = [&](const Material& other) { return other.name == name; };
        while (
            std::any_of(result_.scene.materials.begin(), result_.scene.materials.end(), is_taken)) {
            name += " (simplified)";
        }
        return name;
    }

    void set_material(std::uint32_t id, const Replacement& replacement, Material material) {
        const SubstituteMaterial substitute =
            substitute_material(std::move(material), replacement.surfaces, replacement.area_after);
        result_.scene.materials[id] = substitute.material;
        MaterialChange& change = result_.report.materials[id];
        change.triangles_before = replacement.triangles_before;
        change.triangles_after = replacement.triangles_after;
        change.area_after = replacement.area_after;
        change.removed_depth = substitute.removed_depth;
        change.has_new_data = substitute.is_new;
        change.is_limited = substitute.is_limited;
        const audio::Bands& bands = audio::Bands::octaves();
        const audio::Spectrum after = substitute.material.absorption.over(bands);
        for (const ReplacedSurface& surface : replacement.surfaces) {
            change.area_before += surface.area;
            const audio::Spectrum before = surface.material->absorption.over(bands);
            for (std::size_t band = 0; band < bands.count(); ++band) {
                change.absorption_area_before[band] += surface.area * before[band];
            }
        }
        for (std::size_t band = 0; band < bands.count(); ++band) {
            change.absorption_area_after[band] = replacement.area_after * after[band];
            result_.report.absorption_area_before[band] += change.absorption_area_before[band];
            result_.report.absorption_area_after[band] += change.absorption_area_after[band];
        }
    }

    /// Triangles by mesh, then by material, as files hold them; vertices of a mesh are its own.
    void build_mesh() {
        struct Key {
            SurfaceLabel label;
            std::uint32_t part;
            std::uint32_t triangle;
            auto operator<=>(const Key&) const = default;
        };
        std::vector<Key> order;
        for (std::uint32_t p = 0; p < parts_.size(); ++p) {
            for (std::uint32_t t = 0; t < parts_[p].labels.size(); ++t) {
                SurfaceLabel label = labels_[parts_[p].labels[t]];
                label.material = parts_[p].box ? box_material_[label.material] : label.material;
                order.push_back({label, p, t});
            }
        }
        std::sort(order.begin(), order.end());
        geometry::Mesh mesh;
        std::vector<std::uint32_t> mesh_of_triangle;
        std::map<std::tuple<std::uint32_t, std::uint32_t, VertexId>, VertexId> number;
        for (const Key& key : order) {
            const SimplifiedPart& part = parts_[key.part];
            Triangle triangle = part.mesh.triangles[key.triangle];
            for (VertexId& vertex : triangle) {
                const auto [entry, is_new] =
                    number.emplace(std::tuple(key.label.mesh, key.part, vertex),
                                   static_cast<VertexId>(mesh.positions.size()));
                if (is_new) {
                    mesh.positions.push_back(part.mesh.positions[vertex]);
                }
                vertex = entry->second;
            }
            mesh.triangles.push_back(triangle);
            mesh_of_triangle.push_back(key.label.mesh);
            result_.scene.material_of_triangle.push_back(key.label.material);
        }
        finish(std::move(mesh), std::move(mesh_of_triangle));
    }

    void finish(geometry::Mesh mesh, std::vector<std::uint32_t> mesh_of_triangle) {
        SimplificationReport& report = result_.report;
        report.triangles_after = mesh.triangles.size();
        report.vertices_after = mesh.positions.size();
        for (const Vec3& position : mesh.positions) {
            for (int axis = 0; axis < 3; ++axis) {
                const auto stored = static_cast<double>(static_cast<float>(position[axis]));
                report.max_rounding =
                    std::max(report.max_rounding, std::abs(stored - position[axis]));
            }
        }
        for (const SimplifiedPart& part : parts_) {
            if (part.box) {
                const SurfaceLabel& label = labels_[part.labels.front()];
                report.objects.push_back({.mesh = scene_.mesh.mesh_names()[label.mesh],
                                          .triangles = part.triangles_before,
                                          .box = *part.box,
                                          .material = box_material_[label.material],
                                          .change = part.change});
            }
        }
        Scene& scene = result_.scene;
        scene.name = scene_.name;
        scene.mesh = geometry::AnimatedMesh::fixed(std::move(mesh));
        scene.mesh.set_meshes(scene_.mesh.mesh_names(), std::move(mesh_of_triangle));
        for (const Emitter& source : scene_.sources) {
            scene.sources.push_back(at_rest(source));
        }
        for (const Emitter& listener : scene_.listeners) {
            scene.listeners.push_back(at_rest(listener));
        }
    }

    /// The emitter without the node that it rides on.
    Emitter at_rest(const Emitter& emitter) const {
        const Pose pose = scene_.pose_at(emitter, 0.0);
        return {.name = emitter.name,
                .position = pose.position,
                .directivity = emitter.directivity,
                .looks_at = pose.position + pose.front};
    }

    void find_close_emitters() {
        if (points_.empty()) {
            return;
        }
        const geometry::MeshView mesh{positions_, scene_.mesh.triangles()};
        const bvh::DeformableBvh hierarchy(mesh, {}, executor_);
        const double reach = std::max(options_.max_distance, result_.report.boxes.upper());
        for (std::size_t i = 0; i < points_.size(); ++i) {
            if (const auto found = hierarchy.view().closest_point(points_[i], reach)) {
                const bool is_source = i < scene_.sources.size();
                result_.report.close_emitters.push_back(
                    {.is_source = is_source,
                     .index = is_source ? i : i - scene_.sources.size(),
                     .distance = found->distance});
            }
        }
    }

    const Scene& scene_;
    const SimplificationOptions& options_;
    Executor& executor_;
    std::vector<Vec3> positions_;
    std::vector<Vec3> points_;  // sources, then listeners
    std::vector<SurfaceLabel> labels_;
    std::vector<SimplifiedPart> parts_;
    std::vector<std::uint32_t> box_material_;  // per material of the original
    SimplifiedModel result_;
};

}  // namespace

SimplificationOptions options_for_frequency(double max_frequency_hz, double speed_of_sound) {
    const double wavelength = speed_of_sound / max_frequency_hz;
    return {.max_distance = wavelength / 8.0, .max_object_size = wavelength / 2.0};
}

void validate(const SimplificationOptions& options) {
    geometry::validate(geometry::SimplifyOptions{.max_angle = options.max_angle});
    const auto check = [](bool is_right, const char* subject, const char* remedy) {
        if (!is_right) {
            throw Error(subject, "is out of range", remedy);
        }
    };
    // Written so that what is not a number fails.
    check(options.max_distance >= 1e-4 && options.max_distance <= 1e3,
          "distance of simplification",
          "give 0.0001 to 1000 metres");
    check(options.max_object_size >= 0.0 && options.max_object_size <= 1e3,
          "size of objects",
          "give 0 to 1000 metres");
}

SimplifiedModel simplify_model(const Scene& scene,
                               const SimplificationOptions& options,
                               Executor& executor) {
    validate(options);
    if (scene.mesh.duration() > 0.0) {
        throw Error(scene.name,
                    "moves, and surfaces that are apart now may not be at another instant",
                    "simplify a scene without animation");
    }
    return Simplification(scene, options, executor).run();
}

}  // namespace earshot::propagation
