// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/bands.h"
#include "earshot/base/floating_point.h"
#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/bvh/surface_distance.h"
#include "earshot/geometry/fit.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace earshot::propagation {

// Fewer triangles for sound: docs/simplify.md.

struct SimplificationOptions {
    /// Metres, 0.0001 ... 1000: proved of every connected part, both from the original to what
    /// stands for it and back, and of every material in it.
    double max_distance = 0.01;
    /// Radians, 0 ... pi: the opening of the cone that holds the normals of a triangle and of all
    /// that it replaces.
    double max_angle = 3.141592653589793;
    /// Connected parts of at most this extent become boxes, metres; 0: none by their size alone.
    /// Without it those of up to four times max_distance do whose boxes keep max_distance.
    double max_object_size = 0.0;
    bool boxes = true;  ///< off: all parts keep their shape
    Progress* progress = nullptr;
};

/// Detail that sound of up to a frequency does not tell apart. Distance: an eighth of the
/// wavelength, which changes the phase of what is reflected by up to a quarter of a turn: the
/// Rayleigh criterion of a smooth surface (Beckmann and Spizzichino 1963). Objects: half a
/// wavelength. Precondition: both positive.
SimplificationOptions options_for_frequency(double max_frequency_hz, double speed_of_sound);

/// Throws Error if an option is out of range.
void validate(const SimplificationOptions& options);

/// Distances between an original surface and what stands for it, metres.
struct SurfaceChange {
    bvh::SurfaceDistance to_simplified;  ///< of the original's points
    bvh::SurfaceDistance to_original;    ///< of the points of what stands for it

    /// At most: the Hausdorff distance of both directions.
    double upper() const noexcept {
        return to_simplified.upper > to_original.upper ? to_simplified.upper : to_original.upper;
    }
    /// Takes the larger of both, direction by direction.
    void include(const SurfaceChange& other) noexcept;
};

/// What became of a material.
struct MaterialChange {
    std::size_t triangles_before = 0, triangles_after = 0;
    /// Square metres of the sides that sound can reach: of closed parts the outer one, of open ones
    /// both, unless the material is one-sided.
    double area_before = 0.0, area_after = 0.0;
    /// Equivalent absorption area (absorption times area), square metres per octave.
    audio::Spectrum absorption_area_before{}, absorption_area_after{};
    /// Depth of the structure that was removed, metres: see docs/simplify.md.
    double removed_depth = 0.0;
    bool has_new_data = false;  ///< absorption, scattering or transmission differ from before
    bool is_limited = false;    ///< absorption would exceed 1 in some octave and was cut there
};

/// A connected part that became a box.
struct ReplacedObject {
    std::string mesh;            ///< its name
    std::size_t triangles = 0;   ///< that it had
    geometry::OrientedBox box;   ///< with a half size of 0: a rectangle
    std::uint32_t material = 0;  ///< of the simplified scene
    SurfaceChange change;
};

/// A source or a listener so close to a surface that it may be on its other side now.
struct CloseEmitter {
    bool is_source = false;
    std::size_t index = 0;
    double distance = 0.0;  ///< of the original surface, metres
};

struct SimplificationReport {
    std::size_t triangles_before = 0, triangles_after = 0;
    std::size_t vertices_before = 0, vertices_after = 0;
    std::size_t dropped_triangles = 0;  ///< of these before: degenerate or duplicate (clean.h)
    std::size_t parts = 0;              ///< connected
    std::size_t parts_tightened = 0;    ///< simplified again more closely, as the measure asked
    std::size_t parts_kept = 0;         ///< left as they were, as the measure asked
    SurfaceChange surfaces;             ///< the largest of all parts that are no boxes
    SurfaceChange boxes;                ///< and of those that are
    double solid_volume_before = 0.0;   ///< cubic metres, of closed parts that enclose no air
    double solid_volume_after = 0.0;
    audio::Spectrum absorption_area_before{}, absorption_area_after{};  ///< of all materials
    /// One per material of the simplified scene: first those of the original, then those of boxes.
    std::vector<MaterialChange> materials;
    std::vector<ReplacedObject> objects;
    std::vector<CloseEmitter> close_emitters;
    /// The largest distance of a coordinate from what single precision, as of glTF, keeps of it.
    double max_rounding = 0.0;
};

struct SimplifiedModel {
    Scene scene;
    SimplificationReport report;
};

/// A scene with fewer triangles, in which meshes, materials, sources and listeners keep their
/// names. Connected parts are simplified by geometry::simplify() until their measured distance is
/// kept, or stay as they are. Boxes take the material that has most of the part's area, under its
/// name with ", boxes" added. Each material's absorption and transmission are scaled so that its
/// equivalent absorption area stays, and its scattering grows by the depth that was removed. The
/// result depends on the scene and the options alone. Throws Error if an option is out of range,
/// for a scene that moves, if no triangle has an area, and unless geometry::simplify_available().
SimplifiedModel simplify_model(const Scene& scene,
                               const SimplificationOptions& options = {},
                               Executor& executor = Executor::serial());

}  // namespace earshot::propagation
