// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/error.h"
#include "earshot/base/progress.h"
#include "earshot/collision/contact.h"
#include "earshot/propagation/air.h"
#include "earshot/propagation/response.h"
#include "earshot/propagation/scene.h"

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

/// What the library does, in a few calls: responses, lines of sight and contacts of a scene file.
/// Every call here is made of calls of the folders below, which offer more choice.
namespace earshot {

using geometry::Vec3;
using propagation::Channels;

/// A scene, with what its reader found odd.
struct Room {
    propagation::Scene scene;
    Warnings warnings{};

    /// Adds a source or a listener at a point of the scene, metres.
    void add_source(std::string name,
                    const Vec3& position,
                    const propagation::Directivity& directivity = {});
    void add_listener(std::string name, const Vec3& position);
};

/// Reads a scene file (docs/files.md). Throws Error naming the file and the fault.
Room load(const std::filesystem::path& file);

struct SimulationOptions {
    int order = 4;               ///< max reflections and transmissions of an exact path
    std::size_t rays = 1000000;  ///< of late sound, at most; 0: early sound alone
    /// Relative standard error of T30 at which a listener has enough rays, and 0.05 dB of the level
    /// for each per cent of it; 0: all rays.
    double max_error = 0.02;
    bool transmission = false;
    double time = 0.0;  ///< seconds, of the scene's animation
    propagation::Air air{};
    /// A binaural format without head-related impulse responses takes those of a KEMAR manikin. Its
    /// seed is also that of the rays.
    propagation::ResponseFormat format{};
    int threads = 0;               ///< 0: one per core; changes no result
    Progress* progress = nullptr;  ///< told of "tracing", "late rays" and "responses"
};

/// The impulse response of one source and listener, with the paths and metrics behind it.
struct Response {
    std::string source, listener;
    std::vector<propagation::Path> paths;
    std::vector<audio::ImpulseResponse> channels;
    propagation::PairMetrics metrics;

    /// Expected reverberation time, seconds, the mean of 500 Hz and 1 kHz (ISO 3382-1); empty where
    /// the response does not support it.
    std::optional<double> t30() const;
    /// Writes a 32-bit float WAV file, whole or not at all. Throws Error.
    void write_wav(const std::filesystem::path& file) const;
};

/// One response per pair, ordered by source, then listener.
class Responses {
public:
    explicit Responses(std::vector<Response> responses) : responses_(std::move(responses)) {}

    /// Throws Error if there is no source or listener of that name.
    const Response& at(std::string_view source, std::string_view listener) const;
    std::size_t size() const noexcept { return responses_.size(); }
    auto begin() const noexcept { return responses_.begin(); }
    auto end() const noexcept { return responses_.end(); }

private:
    std::vector<Response> responses_;
};

/// The responses of all sources and listeners of a room. Throws Error if it has no source or no
/// listener, or if an option is out of range.
Responses simulate(const Room& room, const SimulationOptions& options = {});

/// Lines of sight in a room, which need not outlive it.
class Sight {
public:
    explicit Sight(const Room& room, double time = 0.0);
    ~Sight();
    Sight(Sight&&) noexcept;
    Sight& operator=(Sight&&) noexcept;

    /// Moves the geometry to an instant of the room's animation, seconds.
    void set_time(double time);

    /// Whether the closed segment from a to b touches no triangle; one that is grazed blocks.
    bool visible(const Vec3& a, const Vec3& b) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// The meshes of a room, and when they touch. The room need not outlive it.
class World {
public:
    explicit World(const Room& room);
    ~World();
    World(World&&) noexcept;
    World& operator=(World&&) noexcept;

    /// All contacts between two meshes of which one moves, while each vertex moves on a straight
    /// line from its position at `begin` to that at `end` (seconds); sorted by time.
    std::vector<collision::Contact> contacts(double begin, double end);

    /// Seconds; 0: nothing moves.
    double duration() const noexcept;
    /// The name of the mesh that collision::Element::mesh counts.
    const std::string& name_of(std::uint32_t mesh) const;

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace earshot
