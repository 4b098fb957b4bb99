// SPDX-License-Identifier: MIT
#include "support/image_source_oracle.h"

#include "support/oracle_facets.h"
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <tuple>

namespace earshot::support {

namespace {

// An image this close to a mirror's plane (metres) sends it no sound: rays to it run inside it.
constexpr Real kOnPlane = 1e-13L;
// Slack of the pruning tests, so that rounding never gives up a sequence: far above extended
// precision's 5e-20, far below what pruning is worth.
constexpr Real kSlack = 1e-9L;
// Polylines whose points agree to this many metres are one path. Different paths of one order meet
// different planes, and the test rooms have none closer than a millimetre.
constexpr double kSamePath = 1e-7;

// Signed distances of a facet's vertices from another facet's plane.
struct Extent {
    Real low = 0.0L;
    Real high = 0.0L;
};

struct Ball {
    Point centre;
    Real radius = 0.0L;
};

struct Stage {
    std::size_t facet = 0;
    Point image;              // of the source in all mirrors up to this one
    std::vector<Ball> balls;  // of the facets met so far, mirrored with the image
};

// Every cone from `apex` around a ball must share a direction with every other.
bool cones_meet(const Point& apex, const Ball& a, const Ball& b) {
    const Point u = a.centre - apex;
    const Point v = b.centre - apex;
    const Real p = glm::length(u);
    const Real q = glm::length(v);
    if (p <= a.radius || q <= b.radius) {
        return true;
    }
    // Compares cos(angle between the axes) with cos(half angle + half angle); the half angles are
    // below 90 degrees, so the sum is below 180 and the cosine falls all the way.
    const Real sin_a = a.radius / p;
    const Real sin_b = b.radius / q;
    const Real cos_sum = std::sqrt((1.0L - sin_a * sin_a) * (1.0L - sin_b * sin_b)) - sin_a * sin_b;
    return glm::dot(u, v) / (p * q) >= cos_sum - kSlack;
}

class Search {
public:
    Search(std::vector<OracleFacet> facets,
           const geometry::Vec3& source,
           std::span<const geometry::Vec3> listeners,
           const OracleOptions& options,
           Real tolerance)
        : facets_(std::move(facets)),
          source_(source),
          listeners_(listeners),
          options_(options),
          tolerance_(tolerance) {
        for (const OracleFacet& plane : facets_) {
            for (const OracleFacet& other : facets_) {
                extents_.push_back(extent(plane.plane, other));
            }
        }
    }

    OracleResult run() {
        propose();
        extend(Point(source_));
        const auto order = [](const OraclePath& a, const OraclePath& b) {
            return std::make_tuple(a.listener, a.points.size(), a.length) <
                   std::make_tuple(b.listener, b.points.size(), b.length);
        };
        std::stable_sort(result_.paths.begin(), result_.paths.end(), order);
        std::stable_sort(result_.ambiguous.begin(), result_.ambiguous.end(), order);
        return std::move(result_);
    }

private:
    static Extent extent(const OraclePlane& plane, const OracleFacet& facet) {
        Extent result{std::numeric_limits<Real>::max(), std::numeric_limits<Real>::lowest()};
        for (const auto& triangle : facet.triangles) {
            for (const Point& corner : triangle) {
                result.low = std::min(result.low, plane.distance(corner));
                result.high = std::max(result.high, plane.distance(corner));
            }
        }
        return result;
    }

    // Of facet `other` from the plane of facet `plane`.
    const Extent& extent_of(std::size_t other, std::size_t plane) const {
        return extents_[plane * facets_.size() + other];
    }

    bool are_coplanar(std::size_t other, std::size_t plane) const {
        const Extent& e = extent_of(other, plane);
        return e.low >= -tolerance_ && e.high <= tolerance_;
    }

    bool reflects_on_back(const OracleFacet& facet) const {
        const auto& flags = options_.one_sided_labels;
        return facet.label >= flags.size() || flags[facet.label] == 0;
    }

    // Whether sound that seems to come from `image` through the stages so far may meet `next`.
    bool may_follow(const Point& image, std::size_t next) const {
        const OracleFacet& facet = facets_[next];
        const Real side = facet.plane.distance(image);
        if (std::abs(side) <= kOnPlane || (side < 0.0L && !reflects_on_back(facet))) {
            return false;
        }
        if (stages_.empty()) {
            return true;
        }
        const std::size_t last = stages_.back().facet;
        if (next == last || are_coplanar(next, last)) {
            return false;
        }
        if (!options_.prunes) {
            return true;
        }
        // The image stands behind the last mirror: the sound goes to the mirror's other side ...
        const Extent& beyond = extent_of(next, last);
        const bool image_is_low = facets_[last].plane.distance(image) < 0.0L;
        if (image_is_low ? beyond.high <= kSlack : beyond.low >= -kSlack) {
            return false;
        }
        // ... and it leaves the last mirror on the side of the next on which the image stands.
        const Extent& before = extent_of(last, next);
        if (side > 0.0L ? before.high < -kSlack : before.low > kSlack) {
            return false;
        }
        const Ball ball{facet.centre, facet.radius};
        return std::all_of(stages_.back().balls.begin(),
                           stages_.back().balls.end(),
                           [&](const Ball& earlier) { return cones_meet(image, earlier, ball); });
    }

    void extend(const Point& image) {
        if (static_cast<int>(stages_.size()) == options_.max_order) {
            return;
        }
        for (std::size_t next = 0; next < facets_.size(); ++next) {
            if (!may_follow(image, next)) {
                continue;
            }
            const OraclePlane& plane = facets_[next].plane;
            Stage stage{next, plane.mirror(image), {}};
            const bool may_go_on = static_cast<int>(stages_.size()) + 1 < options_.max_order;
            if (may_go_on) {
                if (!stages_.empty()) {
                    for (const Ball& ball : stages_.back().balls) {
                        stage.balls.push_back({plane.mirror(ball.centre), ball.radius});
                    }
                }
                stage.balls.push_back({facets_[next].centre, facets_[next].radius});
            }
            stages_.push_back(std::move(stage));
            propose();
            extend(Point(stages_.back().image));
            stages_.pop_back();
        }
    }

    void propose() {
        for (std::size_t i = 0; i < listeners_.size(); ++i) {
            Real margin = kMarginCap;
            if (const auto points = build(Point(listeners_[i]), margin)) {
                if (legs_are_clear(*points, margin)) {
                    record(i, *points, margin);
                }
            }
        }
    }

    bool is_ruled_out(Real margin) const {
        return margin <= -static_cast<Real>(options_.ambiguity_margin);
    }

    // Reflection points from the listener back to the source; nothing if one is surely no
    // reflection. `margin` takes the smallest margin of the decisions.
    std::optional<std::vector<Point>> build(const Point& listener, Real& margin) const {
        std::vector<Point> points(stages_.size() + 2);
        points.front() = Point(source_);
        points.back() = listener;
        for (std::size_t k = stages_.size(); k > 0; --k) {
            const OracleFacet& facet = facets_[stages_[k - 1].facet];
            const Point& image = stages_[k - 1].image;
            const Point& next = points[k + 1];
            const Real behind = facet.plane.distance(image);
            const Real ahead = facet.plane.distance(next);
            margin = std::min(margin, behind < 0.0L ? ahead : -ahead);
            if (is_ruled_out(margin)) {
                return std::nullopt;
            }
            points[k] = image + (behind / (behind - ahead)) * (next - image);
            if (glm::length(points[k] - facet.centre) > facet.radius + kMarginCap) {
                return std::nullopt;
            }
            margin = std::min(margin, depth_inside(facet, points[k]));
            if (is_ruled_out(margin)) {
                return std::nullopt;
            }
        }
        for (std::size_t k = 1; k <= stages_.size(); ++k) {
            const OraclePlane& plane = facets_[stages_[k - 1].facet].plane;
            const bool air_is_high = plane.distance(stages_[k - 1].image) < 0.0L;
            const Real before = plane.distance(points[k - 1]);
            margin = std::min(margin, air_is_high ? before : -before);
        }
        return is_ruled_out(margin) ? std::nullopt : std::optional(points);
    }

    bool legs_are_clear(const std::vector<Point>& points, Real& margin) const {
        for (std::size_t leg = 0; leg + 1 < points.size(); ++leg) {
            for (std::size_t f = 0; f < facets_.size(); ++f) {
                // A facet in the plane of a reflection is touched at the reflection point only.
                const bool starts_there = leg > 0 && are_coplanar(f, stages_[leg - 1].facet);
                const bool ends_there = leg < stages_.size() && are_coplanar(f, stages_[leg].facet);
                if (starts_there || ends_there) {
                    continue;
                }
                margin = std::min(margin, clearance(facets_[f], points[leg], points[leg + 1]));
                if (is_ruled_out(margin)) {
                    return false;
                }
            }
        }
        return true;
    }

    void record(std::size_t listener, const std::vector<Point>& points, Real margin) {
        OraclePath path;
        path.listener = listener;
        for (const Stage& stage : stages_) {
            path.labels.push_back(facets_[stage.facet].label);
        }
        Real length = 0.0L;
        for (std::size_t i = 0; i < points.size(); ++i) {
            path.points.emplace_back(points[i]);
            length += i > 0 ? glm::length(points[i] - points[i - 1]) : 0.0L;
        }
        path.length = static_cast<double>(length);
        path.margin = static_cast<double>(margin);
        const bool is_certain = path.margin >= options_.ambiguity_margin;
        const auto is_same = [&](const OraclePath& other) { return are_one(path, other); };
        auto& certain = result_.paths;
        auto& ambiguous = result_.ambiguous;
        if (std::any_of(certain.begin(), certain.end(), is_same)) {
            return;
        }
        const auto earlier = std::find_if(ambiguous.begin(), ambiguous.end(), is_same);
        if (!is_certain && earlier != ambiguous.end()) {
            return;
        }
        if (is_certain && earlier != ambiguous.end()) {
            ambiguous.erase(earlier);
        }
        (is_certain ? certain : ambiguous).push_back(std::move(path));
    }

    static bool are_one(const OraclePath& a, const OraclePath& b) {
        return a.listener == b.listener &&
               std::equal(a.points.begin(),
                          a.points.end(),
                          b.points.begin(),
                          b.points.end(),
                          [](const geometry::Vec3& p, const geometry::Vec3& q) {
                              return glm::length(p - q) <= kSamePath;
                          });
    }

    std::vector<OracleFacet> facets_;
    std::vector<Extent> extents_;
    geometry::Vec3 source_;
    std::span<const geometry::Vec3> listeners_;
    const OracleOptions& options_;
    Real tolerance_;
    std::vector<Stage> stages_;
    OracleResult result_;
};

}  // namespace

double default_coplanar_tolerance(const geometry::MeshView& mesh) {
    double largest = 0.0;
    for (const geometry::Vec3& p : mesh.positions) {
        largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    }
    return 4.0 * static_cast<double>(std::numeric_limits<float>::epsilon()) * largest;
}

OracleResult search_image_sources(const geometry::MeshView& mesh,
                                  std::span<const std::uint32_t> labels,
                                  const geometry::Vec3& source,
                                  std::span<const geometry::Vec3> listeners,
                                  const OracleOptions& options) {
    const double tolerance = options.coplanar_tolerance > 0.0 ? options.coplanar_tolerance
                                                              : default_coplanar_tolerance(mesh);
    return Search(group_facets(mesh, labels, tolerance), source, listeners, options, tolerance)
        .run();
}

}  // namespace earshot::support
