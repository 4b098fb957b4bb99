// SPDX-License-Identifier: MIT
#include "support/compare_paths.h"

#include <glm/geometric.hpp>

#include "support/oracle_facets.h"
#include <algorithm>
#include <cmath>
#include <sstream>

namespace earshot::support {

namespace {

using frustum::SpecularPath;

// Lines of Comparison::details: enough to start from, not a flood.
constexpr std::ptrdiff_t kMaxDetails = 6;

void tell(Comparison& comparison,
          const char* what,
          std::size_t listener,
          std::span<const geometry::Vec3> points,
          double length) {
    auto& details = comparison.details;
    if (std::count(details.begin(), details.end(), '\n') >= kMaxDetails) {
        return;
    }
    std::ostringstream line;
    line.precision(17);
    line << what << ": listener " << listener << ", length " << length << ", points";
    for (const geometry::Vec3& p : points) {
        line << " (" << p.x << ", " << p.y << ", " << p.z << ")";
    }
    details += line.str() + "\n";
}

bool agree(const SpecularPath& traced, const OraclePath& path, const PathTolerance& tolerance) {
    return traced.listener == path.listener &&
           std::abs(traced.length - path.length) <= tolerance.length &&
           std::equal(traced.points.begin(),
                      traced.points.end(),
                      path.points.begin(),
                      path.points.end(),
                      [&](const geometry::Vec3& p, const geometry::Vec3& q) {
                          return glm::length(p - q) <= tolerance.point;
                      });
}

// Whether each triangle named has its reflection point, which is judged by the oracle's own test.
bool is_named_well(const SpecularPath& path, const geometry::Mesh& mesh, double tolerance) {
    if (path.points.size() != path.triangles.size() + 2) {
        return false;
    }
    for (std::size_t i = 0; i < path.triangles.size(); ++i) {
        if (path.triangles[i] >= mesh.triangles.size()) {
            return false;
        }
        const std::array<geometry::Triangle, 1> triangle = {mesh.triangles[path.triangles[i]]};
        const std::array<std::uint32_t, 1> label{};
        const OracleFacet facet =
            group_facets({mesh.positions, triangle}, label, kMarginCap).front();
        const Point point(path.points[i + 1]);
        if (std::abs(facet.plane.distance(point)) > static_cast<Real>(tolerance) ||
            depth_inside(facet, point) < -static_cast<Real>(tolerance)) {
            return false;
        }
    }
    return true;
}

}  // namespace

void Comparison::operator+=(const Comparison& other) {
    expected += other.expected;
    ambiguous += other.ambiguous;
    found += other.found;
    missed += other.missed;
    false_paths += other.false_paths;
    doubled += other.doubled;
    misnamed += other.misnamed;
    details += other.details;
}

Comparison compare_paths(std::span<const SpecularPath> traced,
                         const OracleResult& oracle,
                         const geometry::Mesh& mesh,
                         const PathTolerance& tolerance) {
    Comparison result{.expected = oracle.paths.size(),
                      .ambiguous = oracle.ambiguous.size(),
                      .found = traced.size()};
    std::vector<OraclePath> known = oracle.paths;
    known.insert(known.end(), oracle.ambiguous.begin(), oracle.ambiguous.end());
    std::vector<bool> is_met(known.size(), false);
    for (const SpecularPath& path : traced) {
        bool is_known = false;
        bool is_new = false;
        for (std::size_t i = 0; i < known.size() && !is_new; ++i) {
            if (agree(path, known[i], tolerance)) {
                is_known = true;
                is_new = !is_met[i];
                is_met[i] = true;
            }
        }
        if (!is_known) {
            ++result.false_paths;
            tell(result, "false", path.listener, path.points, path.length);
        } else if (!is_new) {
            ++result.doubled;
            tell(result, "doubled", path.listener, path.points, path.length);
        }
        if (!is_named_well(path, mesh, tolerance.point)) {
            ++result.misnamed;
            tell(result, "misnamed", path.listener, path.points, path.length);
        }
    }
    for (std::size_t i = 0; i < oracle.paths.size(); ++i) {
        if (!is_met[i]) {
            ++result.missed;
            const OraclePath& path = known[i];
            std::ostringstream what;
            what << "missed (margin " << path.margin << ")";
            tell(result, what.str().c_str(), path.listener, path.points, path.length);
        }
    }
    return result;
}

}  // namespace earshot::support
