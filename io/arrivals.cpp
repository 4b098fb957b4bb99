// SPDX-License-Identifier: MIT
#include "earshot/io/arrivals.h"

#include "earshot/io/internal/text.h"
#include "earshot/io/whole_file.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <set>
#include <utility>

namespace earshot::io {
namespace {

using propagation::Emitter;
using propagation::MeasuredArrival;

constexpr const char* kRemedy =
    "give SOURCE,LISTENER,SURFACES,TIME or SOURCE,LISTENER,TIME on each line";
constexpr std::string_view kDirect = "direct";
constexpr char kBetweenSurfaces = '>';

std::optional<std::size_t> index_of(const std::vector<Emitter>& emitters, std::string_view name) {
    const auto found = std::find_if(emitters.begin(), emitters.end(), [&](const Emitter& emitter) {
        return emitter.name == name;
    });
    return found == emitters.end()
               ? std::nullopt
               : std::optional(static_cast<std::size_t>(found - emitters.begin()));
}

class ArrivalReader {
public:
    ArrivalReader(const std::filesystem::path& file, const propagation::Scene& scene)
        : file_(file.string()),
          scene_(scene),
          surfaces_(scene.mesh.mesh_names().begin(), scene.mesh.mesh_names().end()) {
        for (const propagation::Material& material : scene.materials) {
            surfaces_.insert(material.name);
        }
    }

    ArrivalTable read(std::string_view text) {
        Lines lines(decoded_text(text, file_));
        while (const auto line = lines.next()) {
            const auto cells = cells_of(*line);
            const bool is_header =
                lines.number() == 1 && std::none_of(cells.begin(), cells.end(), to_number);
            if (!is_header && !trimmed(*line).empty()) {
                line_ = lines.name();
                read_row(cells);
            }
        }
        for (const auto& [pair, count] : unknown_) {
            table_.warnings.push_back({file_,
                                       "the scene has no pair " + shortened(pair.first) + ", " +
                                           shortened(pair.second) + "; " + std::to_string(count) +
                                           (count == 1 ? " arrival" : " arrivals") + " left out"});
        }
        if (table_.arrivals.empty()) {
            throw Error(file_, "holds no arrival of a pair of the scene", kRemedy);
        }
        return std::move(table_);
    }

private:
    [[noreturn]] void refuse(const std::string& what, const std::string& remedy = kRemedy) const {
        throw Error(file_, line_ + " " + what, remedy);
    }

    void read_row(const std::vector<std::string_view>& cells) {
        constexpr std::size_t kWithSurfaces = 4, kWithout = 3;
        if (cells.size() != kWithSurfaces && cells.size() != kWithout) {
            refuse("has " + std::to_string(cells.size()) + " columns");
        }
        constexpr double kMaxTime = 1e6;
        const auto time = to_number(cells.back());
        if (!time || !(*time >= 0.0 && *time <= kMaxTime)) {
            refuse("has the time '" + shortened(cells.back()) + "'", "give seconds from 0 up");
        }
        MeasuredArrival arrival = {.time = *time};
        if (cells.size() == kWithSurfaces) {
            arrival.surfaces = parse_surfaces(cells[2]);
        }
        for (const std::string& name : arrival.surfaces.value_or(std::vector<std::string>{})) {
            if (!surfaces_.contains(name)) {
                refuse("names the surface '" + shortened(name) + "'",
                       "name materials or meshes of the scene; earshot check lists its materials");
            }
        }
        const auto source = index_of(scene_.sources, cells[0]);
        const auto listener = index_of(scene_.listeners, cells[1]);
        if (!source || !listener) {
            ++unknown_[{std::string(cells[0]), std::string(cells[1])}];
            return;
        }
        arrival.source = *source;
        arrival.listener = *listener;
        table_.arrivals.push_back(std::move(arrival));
    }

    std::string file_;
    const propagation::Scene& scene_;
    std::set<std::string> surfaces_;  // names of materials and meshes
    std::string line_;
    std::map<std::pair<std::string, std::string>, std::size_t> unknown_;  // rows of each pair
    ArrivalTable table_;
};

}  // namespace

ArrivalTable read_arrivals(const std::filesystem::path& file, const propagation::Scene& scene) {
    return ArrivalReader(file, scene).read(read_whole_file(file));
}

std::optional<std::vector<std::string>> parse_surfaces(std::string_view text) {
    text = trimmed(text);
    if (text.empty()) {
        return std::nullopt;
    }
    std::vector<std::string> names;
    if (text == kDirect) {
        return names;
    }
    for (std::size_t end = 0; end != std::string_view::npos;) {
        end = text.find(kBetweenSurfaces);
        names.emplace_back(trimmed(text.substr(0, end)));
        text = end == std::string_view::npos ? text : text.substr(end + 1);
    }
    return names;
}

std::string surfaces_text(const propagation::Scene& scene,
                          std::span<const geometry::TriangleId> triangles) {
    std::string text;
    for (const geometry::TriangleId triangle : triangles) {
        text += (text.empty() ? "" : std::string(1, kBetweenSurfaces)) +
                scene.materials[scene.material_of_triangle[triangle]].name;
    }
    return triangles.empty() ? std::string(kDirect) : text;
}

}  // namespace earshot::io
