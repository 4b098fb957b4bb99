// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/base/progress.h"
#include "earshot/geometry/mesh_topology.h"
#include "earshot/propagation/plausibility.h"
#include "earshot/propagation/room_statistics.h"
#include "earshot/propagation/scene.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace earshot::propagation {

// What a model needs before its results are trusted: docs/check.md.

/// A part of the model, by its bounding box.
struct ModelPlace {
    geometry::Vec3 centre{0.0};  ///< metres
    geometry::Vec3 size{0.0};
    double area = 0.0;  ///< square metres
};

/// An opening between the air of the sources and what is no part of it.
struct Leak {
    ModelPlace place{};
    bool escapes = false;  ///< out of the scene; else into a solid or another air
    /// Index into MeshTopology::holes; kNoHole: a gap between borders, without a loop of its own.
    std::size_t hole = kNoHole;

    static constexpr std::size_t kNoHole = static_cast<std::size_t>(-1);
};

enum class EmitterFault : std::uint8_t {
    in_solid,
    outside,
    sealed  ///< in an air of its own: no listener for a source, no source for a listener
};

/// A source or a listener at a place where it is of no use.
struct MisplacedEmitter {
    bool is_source = false;
    std::size_t index = 0;  ///< among the scene's sources or listeners
    geometry::Vec3 position{0.0};
    EmitterFault fault = EmitterFault::in_solid;
    /// A closed surface that does not transmit sound parts it from the others; else the judgement
    /// of sampled rays.
    bool is_proven = false;
};

/// Connected triangles with the same fault.
struct FaceGroup {
    ModelPlace place{};
    std::size_t triangles = 0;
    geometry::TriangleId first_triangle = 0;
    bool is_reversed = false;  ///< of doubled faces: the copy faces the other way
};

/// Sources and listeners that rays link, and their air.
struct SharedAir {
    std::vector<std::size_t> sources, listeners;
    double volume = 0.0;   ///< cubic metres; 0: unknown, as outdoors
    double surface = 0.0;  ///< square metres
};

/// Where the data of a material come from.
enum class MaterialOrigin : std::uint8_t {
    none,     ///< there are none: the default
    by_name,  ///< guessed: those of the library's material of that name
    library,  ///< stated, and equal to those of the library's material of that name
    stated
};

/// Doubts about the data of a material: "a wall absorbs nothing at any frequency".
inline constexpr const char* kAbsorbsNothing = "absorbs nothing";
inline constexpr const char* kAbsorbsEverything = "absorbs everything";
inline constexpr const char* kAbsorbsTheSame = "absorbs the same";
inline constexpr const char* kScattersNothing = "scatters nothing";

/// The part of a material in the surface of the air.
struct MaterialUse {
    MaterialOrigin origin = MaterialOrigin::stated;
    double area = 0.0;                ///< square metres, of sides that were reached
    double absorption_share = 0.0;    ///< of the absorbed energy, mean of 500 Hz and 1 kHz
    std::vector<std::string> doubts;  ///< of those above; none about the library's data
};

/// Facets whose largest extent is below half a wavelength: they do not reflect like mirrors there.
struct SmallFacets {
    double frequency_hz = 0.0;
    double half_wavelength = 0.0;  ///< metres
    std::size_t facets = 0;
    double area = 0.0;        ///< square metres
    double area_share = 0.0;  ///< of all facets
};

/// The time of `earshot ir` without late rays, all pairs.
struct OrderCost {
    int order = 0;
    double seconds = 0.0;
    bool is_measured = false;  ///< else estimated from a share of the beam tree
};

struct ModelReport {
    SceneExtent extent;
    ModelKind kind = ModelKind::room;  ///< outdoors also if the air goes on beyond the scene
    std::optional<UnitProposal> unit;  ///< set if the size is not that of its kind
    geometry::MeshTopology topology;
    /// Where the air was looked for if the scene has no source and no listener.
    std::optional<geometry::Vec3> probe;
    std::vector<SharedAir> airs;
    bool is_open = false;  ///< the air goes on beyond the scene, as outdoors
    std::vector<Leak> leaks;
    std::vector<MisplacedEmitter> misplaced;
    std::vector<FaceGroup> reversed;  ///< with only their backs in the air
    std::vector<FaceGroup> doubled;
    std::vector<geometry::TriangleId> reversed_triangles;
    /// Triangles of which neither side was reached, ascending, and of these those that a closed
    /// surface is proved to keep all sources and listeners from.
    std::vector<geometry::TriangleId> unreached, proven_unreached;
    std::uint64_t rays = 0;              ///< that looked for the air
    std::vector<MaterialUse> materials;  ///< one per material of the scene
    std::vector<SmallFacets> small_facets;
    std::vector<OrderCost> costs;  ///< empty without a source and a listener
};

struct ModelCheckOptions {
    ReadAs read_as{};
    /// Indices of materials, ascending: without data, and with data guessed by their names.
    std::span<const std::uint32_t> default_materials{}, materials_by_name{};
    double time = 0.0;  ///< seconds
    std::uint64_t seed = 1;
    std::uint64_t max_rays = 20'000'000;  ///< that sides send to find the air; no more find leaks
    double lambda = 0.01;                 ///< see visibility::AirCutOptions
    double forecast_seconds = 2.0;        ///< spent on measuring; 0: no forecast
    bool sampling = true;                 ///< off: topology alone
    Progress* progress = nullptr;         ///< receives "air", "leaks", "openings" and "forecast"
};

/// Examines a scene at one instant. All but the costs depends on the scene and the options alone.
/// Throws Error if no triangle has an area, and as geometry::find_topology().
ModelReport check_model(const Scene& scene,
                        const ModelCheckOptions& options = {},
                        Executor& executor = Executor::serial());

}  // namespace earshot::propagation
