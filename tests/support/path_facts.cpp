// SPDX-License-Identifier: MIT
#include "support/path_facts.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace earshot::support {

namespace {

std::string text(std::size_t order, double length, std::span<const std::uint32_t> labels) {
    std::ostringstream stream;
    stream.precision(17);
    stream << "order " << order << ", length " << length << ", walls";
    for (const std::uint32_t label : labels) {
        stream << ' ' << label;
    }
    return stream.str();
}

// Matches two lists one to one and tells what is left on either side.
template <typename Wanted, typename Agrees, typename Describe>
std::string unmatched(std::span<const PathFacts> paths,
                      std::span<const Wanted> wanted,
                      const Agrees& agrees,
                      const Describe& describe) {
    std::vector<bool> is_used(paths.size(), false);
    std::string complaint;
    for (const Wanted& one : wanted) {
        bool is_found = false;
        for (std::size_t i = 0; i < paths.size() && !is_found; ++i) {
            is_found = !is_used[i] && agrees(paths[i], one);
            is_used[i] = is_used[i] || is_found;
        }
        if (!is_found) {
            complaint += "missed: " + describe(one) + "\n";
        }
    }
    for (std::size_t i = 0; i < paths.size(); ++i) {
        if (!is_used[i]) {
            complaint += "extra: " + text(paths[i].order, paths[i].length, paths[i].labels) + "\n";
        }
    }
    return complaint;
}

std::array<int, 6> bounces_of(const PathFacts& path) {
    std::array<int, 6> bounces{};
    for (const std::uint32_t label : path.labels) {
        ++bounces.at(label);
    }
    return bounces;
}

}  // namespace

geometry::Vec3 apparent_source(std::span<const geometry::Vec3> points, double length) {
    const geometry::Vec3& listener = points.back();
    // A reflection in a corner repeats its point, and a listener may stand where the source does.
    for (std::size_t i = points.size() - 1; i > 0; --i) {
        const geometry::Vec3 back = points[i - 1] - listener;
        if (glm::length(back) > 0.0) {
            return listener + (length / glm::length(back)) * back;
        }
    }
    return listener;
}

std::vector<PathFacts> facts_of(std::span<const OraclePath> paths) {
    std::vector<PathFacts> facts;
    for (const OraclePath& path : paths) {
        facts.push_back({.order = path.labels.size(),
                         .length = path.length,
                         .labels = path.labels,
                         .image = apparent_source(path.points, path.length)});
    }
    return facts;
}

std::string disagreement(std::span<const PathFacts> paths,
                         std::span<const ShoeboxImage> images,
                         double relative_tolerance) {
    return unmatched<ShoeboxImage>(
        paths,
        images,
        [&](const PathFacts& path, const ShoeboxImage& image) {
            const double tolerance = relative_tolerance * image.length;
            return path.order == static_cast<std::size_t>(image.order) &&
                   std::abs(path.length - image.length) <= tolerance &&
                   glm::length(path.image - image.position) <= tolerance &&
                   bounces_of(path) == image.bounces;
        },
        [](const ShoeboxImage& image) {
            std::vector<std::uint32_t> labels;
            for (std::uint32_t wall = 0; wall < 6; ++wall) {
                labels.insert(labels.end(), static_cast<std::size_t>(image.bounces[wall]), wall);
            }
            return text(static_cast<std::size_t>(image.order), image.length, labels);
        });
}

std::string disagreement(std::span<const PathFacts> paths,
                         std::span<const TabledPath> table,
                         double tolerance) {
    return unmatched<TabledPath>(
        paths,
        table,
        [&](const PathFacts& path, const TabledPath& line) {
            return path.order == static_cast<std::size_t>(line.order) &&
                   path.labels == line.walls && std::abs(path.length - line.length) <= tolerance &&
                   glm::length(path.image - line.image) <= tolerance;
        },
        [](const TabledPath& line) {
            return text(static_cast<std::size_t>(line.order), line.length, line.walls);
        });
}

}  // namespace earshot::support
