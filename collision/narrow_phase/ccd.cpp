// SPDX-License-Identifier: MIT
#include "earshot/collision/narrow_phase/ccd.h"

#include "earshot/collision/narrow_phase/internal/exact_ccd.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>

namespace earshot::collision {

using geometry::Vec3;

namespace {

// The unit roundoff of double, increased a little to cover the rounding of the bounds themselves.
constexpr double kUnitRoundoff = 0x1.01p-53;

/// A polynomial in Bernstein form over an interval of time; each coefficient is within `error` of
/// the true one.
template <std::size_t kSize>
struct BernsteinForm {
    std::array<double, kSize> coefficients{};
    double error = 0.0;

    /// 1 or -1 if the polynomial certainly has that sign over the whole interval, else 0.
    int sign() const {
        const auto [min, max] = std::minmax_element(coefficients.begin(), coefficients.end());
        return *min > error ? 1 : *max < -error ? -1 : 0;
    }
    int sign_at_begin() const { return sign_of(coefficients.front()); }
    int sign_at_end() const { return sign_of(coefficients.back()); }

private:
    int sign_of(double value) const { return value > error ? 1 : value < -error ? -1 : 0; }
};

/// Subdivides at the middle by de Casteljau's algorithm. A coefficient is the result of at most
/// kSize - 1 means, each rounded once.
template <std::size_t kSize>
void subdivide(const BernsteinForm<kSize>& whole,
               BernsteinForm<kSize>& lower,
               BernsteinForm<kSize>& upper) {
    std::array<double, kSize> row = whole.coefficients;
    double largest = 0.0;
    for (const double value : row) {
        largest = std::max(largest, std::abs(value));
    }
    lower.coefficients[0] = row[0];
    upper.coefficients[kSize - 1] = row[kSize - 1];
    for (std::size_t level = 1; level < kSize; ++level) {
        for (std::size_t i = 0; i + level < kSize; ++i) {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
        lower.coefficients[level] = row[0];
        upper.coefficients[kSize - 1 - level] = row[kSize - 1 - level];
    }
    lower.error = upper.error = whole.error + static_cast<double>(kSize) * kUnitRoundoff * largest;
}

double magnitude(const Vec3& begin, const Vec3& end) {
    const Vec3 largest = glm::max(glm::abs(begin), glm::abs(end));
    return std::max({largest.x, largest.y, largest.z});
}

double cross(const Vec3& a, const Vec3& b, int axis) {
    const int i = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    return a[i] * b[k] - a[k] * b[i];
}

/// A moving edge vector: the difference of two points at both ends of the step, each
/// component rounded once.
struct MovingEdge {
    Vec3 begin, end;
    double max_component;  // largest absolute value

    MovingEdge(const MovingPoints& points, std::size_t from, std::size_t to)
        : begin(points.begin[to] - points.begin[from]),
          end(points.end[to] - points.end[from]),
          max_component(magnitude(begin, end)) {}
};

/// Component `axis` of the cross product. It is computed from two products, whose factors are
/// rounded once each, and at most four sums, so its error is at most 16 unit roundoffs of the
/// largest product.
BernsteinForm<3> cross(const MovingEdge& a, const MovingEdge& b, int axis) {
    return {{cross(a.begin, b.begin, axis),
             0.5 * (cross(a.begin, b.end, axis) + cross(a.end, b.begin, axis)),
             cross(a.end, b.end, axis)},
            16.0 * kUnitRoundoff * (a.max_component * b.max_component)};
}

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
    return glm::dot(glm::cross(a, b), c);
}

/// The determinant is a sum of six products of three such factors, so its error is at most 64 unit
/// roundoffs of the largest product.
BernsteinForm<4> determinant(const MovingEdge& a, const MovingEdge& b, const MovingEdge& c) {
    constexpr double kThird = 1.0 / 3.0;
    return {{determinant(a.begin, b.begin, c.begin),
             kThird * (determinant(a.end, b.begin, c.begin) + determinant(a.begin, b.end, c.begin) +
                       determinant(a.begin, b.begin, c.end)),
             kThird * (determinant(a.begin, b.end, c.end) + determinant(a.end, b.begin, c.end) +
                       determinant(a.end, b.end, c.begin)),
             determinant(a.end, b.end, c.end)},
            64.0 * kUnitRoundoff * (a.max_component * b.max_component * c.max_component)};
}

BernsteinForm<3> difference(const BernsteinForm<3>& a, const BernsteinForm<3>& b) {
    BernsteinForm<3> result;
    double largest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        result.coefficients[i] = a.coefficients[i] - b.coefficients[i];
        largest = std::max(largest, std::abs(result.coefficients[i]));
    }
    result.error = a.error + b.error + kUnitRoundoff * largest;
    return result;
}

/// The polynomials of a query over an interval of time. There is a contact at a time at which the
/// volume of the tetrahedron of the four points is 0 and every inside condition is 0 or has the
/// sign of the area.
struct TimeInterval {
    BernsteinForm<4> volume;
    BernsteinForm<3> area;
    std::array<BernsteinForm<3>, 4> inside_conditions;
    double begin = 0.0, width = 1.0;
};

enum class Decision { no_contact, contact, unknown };

struct QueryResult {
    Decision decision = Decision::no_contact;
    double time = 0.0;
};

bool violates_inside_condition(const TimeInterval& interval, int area) {
    return area != 0 &&
           std::any_of(interval.inside_conditions.begin(),
                       interval.inside_conditions.end(),
                       [&](const auto& condition) { return condition.sign() == -area; });
}

bool is_certain_contact(const TimeInterval& interval, int area) {
    return area != 0 && interval.volume.sign_at_begin() * interval.volume.sign_at_end() < 0 &&
           std::all_of(interval.inside_conditions.begin(),
                       interval.inside_conditions.end(),
                       [&](const auto& condition) { return condition.sign() == area; });
}

/// The polynomial over the part [0, parameter] of its interval. Each step of de Casteljau's
/// algorithm rounds three times.
BernsteinForm<4> restricted_to(const BernsteinForm<4>& whole, double parameter) {
    BernsteinForm<4> restricted;
    std::array<double, 4> row = whole.coefficients;
    double largest = 0.0;
    for (const double value : row) {
        largest = std::max(largest, std::abs(value));
    }
    restricted.coefficients[0] = row[0];
    for (std::size_t level = 1; level < 4; ++level) {
        for (std::size_t i = 0; i + level < 4; ++i) {
            row[i] += parameter * (row[i + 1] - row[i]);
        }
        restricted.coefficients[level] = row[0];
    }
    restricted.error = whole.error + 24.0 * kUnitRoundoff * largest;
    return restricted;
}

/// The largest parameter in [0, 1] for which bisection finds the predicate `holds` to be true.
/// Precondition: it is true at 0.
template <class Holds>
double largest_parameter(const Holds& holds) {
    double low = 0.0, high = 1.0;
    constexpr double kWidth = 0x1p-48;
    while (high - low > kWidth) {
        const double midpoint = 0.5 * (low + high);
        (holds(midpoint) ? low : high) = midpoint;
    }
    return low;
}

/// A lower bound of a simple root by Newton's method. Returns nothing if the signs of the
/// polynomial below and above the root are not certain.
std::optional<double> newton_root(const BernsteinForm<4>& volume, double max_error) {
    const auto& b = volume.coefficients;
    const std::array<double, 3> slopes{
        3.0 * (b[1] - b[0]), 3.0 * (b[2] - b[1]), 3.0 * (b[3] - b[2])};
    double root = b[0] / (b[0] - b[3]);
    double slope = 0.0;
    for (int step = 0; step < 6; ++step) {
        const double complement = 1.0 - root;
        const double value = complement * complement * (complement * b[0] + 3.0 * root * b[1]) +
                             root * root * (3.0 * complement * b[2] + root * b[3]);
        slope = complement * (complement * slopes[0] + 2.0 * root * slopes[1]) +
                root * root * slopes[2];
        root = std::clamp(root - value / slope, 0.0, 1.0);
    }
    const double error = std::min(max_error, 4.0 * volume.error / std::abs(slope) + 0x1p-46);
    const double lower_bound = root - error;
    const double upper_bound = root + error;
    const int sign = volume.sign_at_begin();
    // These comparisons are false for NaN.
    if (lower_bound >= 0.0 && upper_bound <= 1.0 &&
        restricted_to(volume, lower_bound).sign() == sign &&
        restricted_to(volume, upper_bound).sign_at_end() == -sign) {
        return lower_bound;
    }
    return std::nullopt;
}

/// A lower bound of the first root, at most 2^-40 below it. Returns nothing if the rounding error
/// is too large to locate the root so closely. Precondition: the signs at both ends are certain and
/// differ.
std::optional<double> first_root_of(BernsteinForm<4> volume, double begin, double width) {
    constexpr double kTolerance = 0x1p-40;
    // Subdivide a few times, at most until the sign in the middle is not certain.
    constexpr int kMaxSubdivisions = 4;
    for (int i = 0; i < kMaxSubdivisions; ++i) {
        BernsteinForm<4> lower, upper;
        subdivide(volume, lower, upper);
        if (lower.sign() != 0) {
            begin += 0.5 * width;
            volume = upper;
        } else if (lower.sign_at_begin() * lower.sign_at_end() < 0) {
            volume = lower;
        } else {
            break;
        }
        width *= 0.5;
    }
    if (const auto lower_bound = newton_root(volume, 0.5 * kTolerance / width)) {
        return std::max(begin, begin + *lower_bound * width - 0x1p-52);
    }
    const int sign = volume.sign_at_begin();
    const double lower_bound = largest_parameter(
        [&](double parameter) { return restricted_to(volume, parameter).sign() == sign; });
    const double upper_bound = largest_parameter(
        [&](double parameter) { return restricted_to(volume, parameter).sign_at_end() != -sign; });
    if ((upper_bound - lower_bound) * width > kTolerance) {
        return std::nullopt;
    }
    // The subtracted 2^-52 covers the rounding of the sum.
    return std::max(begin, begin + lower_bound * width - 0x1p-52);
}

/// Decides a query by recursive subdivision of time, earlier intervals first.
QueryResult decide_by_subdivision(const TimeInterval& whole) {
    constexpr int kMaxIntervals = 48;
    constexpr std::size_t kMaxStackSize = 16;
    std::array<TimeInterval, kMaxStackSize> stack;
    std::size_t count = 1;
    stack[0] = whole;
    for (int tested = 0; tested < kMaxIntervals && count > 0; ++tested) {
        const TimeInterval interval = stack[--count];
        if (interval.volume.sign() != 0) {
            continue;
        }
        const int area = interval.area.sign();
        if (violates_inside_condition(interval, area)) {
            continue;
        }
        if (is_certain_contact(interval, area)) {
            const auto time = first_root_of(interval.volume, interval.begin, interval.width);
            return time ? QueryResult{Decision::contact, *time} : QueryResult{Decision::unknown};
        }
        if (count + 2 > kMaxStackSize) {
            return {Decision::unknown};
        }
        TimeInterval& upper = stack[count];
        TimeInterval& lower = stack[count + 1];
        subdivide(interval.volume, lower.volume, upper.volume);
        subdivide(interval.area, lower.area, upper.area);
        for (std::size_t i = 0; i < interval.inside_conditions.size(); ++i) {
            subdivide(interval.inside_conditions[i],
                      lower.inside_conditions[i],
                      upper.inside_conditions[i]);
        }
        lower.width = upper.width = 0.5 * interval.width;
        lower.begin = interval.begin;
        upper.begin = interval.begin + lower.width;
        count += 2;
    }
    return {count == 0 ? Decision::no_contact : Decision::unknown};
}

/// Whether products of three components neither underflow nor overflow, so that the error bounds
/// hold.
bool error_bounds_hold(double largest_product) {
    return largest_product > 1e-200 && largest_product < 1e200;
}

int largest_axis(const Vec3& v) {
    const Vec3 size = glm::abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// Whether along a coordinate axis all of the first `count` points lie on one side of all other
/// points at both ends of the step, and therefore during the whole step. Coordinates are only
/// compared, so nothing is rounded.
bool disjoint_along_axes(const MovingPoints& points, std::size_t count) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto side = [&](const std::array<Vec3, 4>& at) {
            double lower = at[0][axis], upper = at[0][axis];
            for (std::size_t i = 1; i < count; ++i) {
                lower = std::min(lower, at[i][axis]);
                upper = std::max(upper, at[i][axis]);
            }
            double other_lower = at[count][axis], other_upper = at[count][axis];
            for (std::size_t i = count + 1; i < 4; ++i) {
                other_lower = std::min(other_lower, at[i][axis]);
                other_upper = std::max(other_upper, at[i][axis]);
            }
            return upper < other_lower ? 1 : other_upper < lower ? -1 : 0;
        };
        const int begin = side(points.begin);
        if (begin != 0 && begin == side(points.end)) {
            return true;
        }
    }
    return false;
}

/// As disjoint_along_axes(), along any direction. The error of a projection is at most 8 unit
/// roundoffs of the largest product. Projections are relative to the last point.
bool disjoint_along(const MovingPoints& points, std::size_t count, const Vec3& direction) {
    const double length = magnitude(direction, direction);
    int side = 0;
    for (const auto* at : {&points.begin, &points.end}) {
        std::array<double, 4> projection{};
        double largest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 offset = (*at)[i] - (*at)[3];
            projection[i] = glm::dot(offset, direction);
            largest = std::max(largest, magnitude(offset, offset));
        }
        // The added constant covers products that underflow.
        const double error = 8.0 * kUnitRoundoff * (3.0 * largest * length) + 1e-300;
        const auto second_begin = projection.begin() + static_cast<std::ptrdiff_t>(count);
        const auto [lower, upper] = std::minmax_element(projection.begin(), second_begin);
        const auto [other_lower, other_upper] = std::minmax_element(second_begin, projection.end());
        const int side_here = *other_lower - *upper > 2.0 * error   ? 1
                              : *lower - *other_upper > 2.0 * error ? -1
                                                                    : 0;
        if (side_here == 0 || side_here == -side) {
            return false;
        }
        side = side_here;
    }
    return true;
}

/// As disjoint_along(), along the directions that separate coplanar features and parallel edges:
/// the normals of the edges and the offset between the features, in the middle of the step.
bool disjoint_along_edge_normals(const MovingPoints& points, std::size_t count) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = 0.5 * (points.begin[i] + points.end[i]);
    }
    const Vec3 offset = x[count] - x[0];
    const Vec3 first_edge = count == 2 ? x[1] - x[0] : x[2] - x[1];
    const Vec3 second_edge = x[3] - x[2];
    const std::array<Vec3, 5> directions{
        offset,
        glm::cross(first_edge, second_edge),
        glm::cross(glm::cross(first_edge, offset), first_edge),
        glm::cross(glm::cross(second_edge, offset), second_edge),
        count == 2 ? offset : glm::cross(glm::cross(x[3] - x[1], offset), x[3] - x[1])};
    return std::any_of(directions.begin(), directions.end(), [&](const Vec3& direction) {
        const double length = magnitude(direction, direction);
        return length > 1e-100 && length < 1e100 &&
               disjoint_along(points, count, direction / length);
    });
}

/// The query of the first point against the triangle of the other three.
struct VertexFace {
    static constexpr std::size_t kFirstCount = 1;
    MovingEdge ab, ac, ap;

    explicit VertexFace(const MovingPoints& points)
        : ab(points, 1, 2), ac(points, 1, 3), ap(points, 1, 0) {}

    BernsteinForm<4> volume() const { return determinant(ab, ac, ap); }
    double magnitude() const { return ab.max_component * ac.max_component * ap.max_component; }

    /// The points are projected along the axis along which the triangle's area is largest. The
    /// first point is inside if the areas of the three triangles that it forms with the edges have
    /// the sign of the triangle's area.
    void set_inside_conditions(TimeInterval& whole) const {
        const int axis = largest_axis(glm::cross(ab.begin + ab.end, ac.begin + ac.end));
        whole.area = cross(ab, ac, axis);
        whole.inside_conditions[0] = cross(ab, ap, axis);
        whole.inside_conditions[1] = cross(ap, ac, axis);
        whole.inside_conditions[2] = difference(difference(whole.area, whole.inside_conditions[0]),
                                                whole.inside_conditions[1]);
        whole.inside_conditions[3] = whole.inside_conditions[0];
    }
    static std::optional<double> exact(const IntegerPoints& points) {
        return exact_vertex_face_ccd(points);
    }
};

/// The query of the segment of the first two points against the segment of the last two.
struct EdgeEdge {
    static constexpr std::size_t kFirstCount = 2;
    MovingEdge ab, cd, ac;

    explicit EdgeEdge(const MovingPoints& points)
        : ab(points, 0, 1), cd(points, 2, 3), ac(points, 0, 2) {}

    BernsteinForm<4> volume() const { return determinant(ab, cd, ac); }
    double magnitude() const { return ab.max_component * cd.max_component * ac.max_component; }

    /// a + u ab = c + v cd: u = ac x cd / ab x cd and v = ac x ab / ab x cd are both in 0 ... 1.
    void set_inside_conditions(TimeInterval& whole) const {
        const int axis = largest_axis(glm::cross(ab.begin + ab.end, cd.begin + cd.end));
        whole.area = cross(ab, cd, axis);
        whole.inside_conditions[0] = cross(ac, cd, axis);
        whole.inside_conditions[1] = difference(whole.area, whole.inside_conditions[0]);
        whole.inside_conditions[2] = cross(ac, ab, axis);
        whole.inside_conditions[3] = difference(whole.area, whole.inside_conditions[2]);
    }
    static std::optional<double> exact(const IntegerPoints& points) {
        return exact_edge_edge_ccd(points);
    }
};

/// The stages of docs/algorithms/collision.md: each decides the queries that it can prove, and
/// passes the others on.
template <class Features>
std::optional<double> ccd(const MovingPoints& points) {
    // 1. Separating coordinate axes.
    if (disjoint_along_axes(points, Features::kFirstCount)) {
        return std::nullopt;
    }
    const Features features(points);
    TimeInterval whole;
    whole.volume = features.volume();
    if (error_bounds_hold(features.magnitude())) {
        // 2. The sign of the volume.
        if (whole.volume.sign() != 0) {
            return std::nullopt;
        }
        // 3. Subdivision of time.
        features.set_inside_conditions(whole);
        const QueryResult result = decide_by_subdivision(whole);
        if (result.decision != Decision::unknown) {
            return result.decision == Decision::contact ? std::optional(result.time) : std::nullopt;
        }
    }
    // 4. Separating directions of coplanar features.
    if (disjoint_along_edge_normals(points, Features::kFirstCount)) {
        return std::nullopt;
    }
    // 5. Exact decision in arbitrary-precision integers.
    return Features::exact(integers_of(points));
}

}  // namespace

std::optional<double> vertex_face_ccd(const MovingPoints& points) {
    return ccd<VertexFace>(points);
}

std::optional<double> edge_edge_ccd(const MovingPoints& points) {
    return ccd<EdgeEdge>(points);
}

}  // namespace earshot::collision
