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

// Half an ulp of 1, with room for the bounds' own rounding.
constexpr double kRounding = 0x1.01p-53;

/// Bernstein coefficients over an interval of time, each within `error` of the true ones.
template <std::size_t kSize>
struct Bends {
    std::array<double, kSize> b{};
    double error = 0.0;

    /// 1 or -1 if it has that sign over the whole interval, else 0.
    int sign() const {
        const auto [least, most] = std::minmax_element(b.begin(), b.end());
        return *least > error ? 1 : *most < -error ? -1 : 0;
    }
    int sign_at_begin() const { return b.front() > error ? 1 : b.front() < -error ? -1 : 0; }
    int sign_at_end() const { return b.back() > error ? 1 : b.back() < -error ? -1 : 0; }
};

/// de Casteljau; every mean is rounded once, and kSize - 1 times at most.
template <std::size_t kSize>
void halve(const Bends<kSize>& whole, Bends<kSize>& lower, Bends<kSize>& upper) {
    std::array<double, kSize> row = whole.b;
    double largest = 0.0;
    for (const double value : row) {
        largest = std::max(largest, std::abs(value));
    }
    lower.b[0] = row[0];
    upper.b[kSize - 1] = row[kSize - 1];
    for (std::size_t level = 1; level < kSize; ++level) {
        for (std::size_t i = 0; i + level < kSize; ++i) {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
        lower.b[level] = row[0];
        upper.b[kSize - 1 - level] = row[kSize - 1 - level];
    }
    lower.error = upper.error = whole.error + static_cast<double>(kSize) * kRounding * largest;
}

double magnitude(const Vec3& begin, const Vec3& end) {
    const Vec3 most = glm::max(glm::abs(begin), glm::abs(end));
    return std::max({most.x, most.y, most.z});
}

double cross(const Vec3& a, const Vec3& b, int axis) {
    const int i = (axis + 1) % 3;
    const int k = (axis + 2) % 3;
    return a[i] * b[k] - a[k] * b[i];
}

/// A difference of two points, at both ends of the step, each component rounded once.
struct Way {
    Vec3 begin, end;
    double most;  // no component is larger

    Way(const MovingPoints& points, std::size_t from, std::size_t to)
        : begin(points.begin[to] - points.begin[from]),
          end(points.end[to] - points.end[from]),
          most(magnitude(begin, end)) {}
};

/// Component `axis` of the cross product. Two products of factors that are rounded once each, and
/// then at most four sums: within 16 roundings of the largest product.
Bends<3> cross(const Way& a, const Way& b, int axis) {
    return {{cross(a.begin, b.begin, axis),
             0.5 * (cross(a.begin, b.end, axis) + cross(a.end, b.begin, axis)),
             cross(a.end, b.end, axis)},
            16.0 * kRounding * (a.most * b.most)};
}

double determinant(const Vec3& a, const Vec3& b, const Vec3& c) {
    return glm::dot(glm::cross(a, b), c);
}

/// Six products of three such factors: within 64 roundings of the largest.
Bends<4> determinant(const Way& a, const Way& b, const Way& c) {
    constexpr double kThird = 1.0 / 3.0;
    return {{determinant(a.begin, b.begin, c.begin),
             kThird * (determinant(a.end, b.begin, c.begin) + determinant(a.begin, b.end, c.begin) +
                       determinant(a.begin, b.begin, c.end)),
             kThird * (determinant(a.begin, b.end, c.end) + determinant(a.end, b.begin, c.end) +
                       determinant(a.end, b.end, c.begin)),
             determinant(a.end, b.end, c.end)},
            64.0 * kRounding * (a.most * b.most * c.most)};
}

Bends<3> difference(const Bends<3>& a, const Bends<3>& b) {
    Bends<3> result;
    double largest = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        result.b[i] = a.b[i] - b.b[i];
        largest = std::max(largest, std::abs(result.b[i]));
    }
    result.error = a.error + b.error + kRounding * largest;
    return result;
}

/// There is a contact where the volume is 0 and every condition has the sign of the area or is 0.
struct Part {
    Bends<4> volume;
    Bends<3> area;
    std::array<Bends<3>, 4> conditions;
    double begin = 0.0, width = 1.0;
};

enum class Verdict { none, contact, unknown };

struct Answer {
    Verdict verdict = Verdict::none;
    double time = 0.0;
};

bool conditions_exclude(const Part& part, int area) {
    return area != 0 &&
           std::any_of(part.conditions.begin(), part.conditions.end(), [&](const auto& condition) {
               return condition.sign() == -area;
           });
}

bool is_contact(const Part& part, int area) {
    return area != 0 && part.volume.sign_at_begin() * part.volume.sign_at_end() < 0 &&
           std::all_of(part.conditions.begin(), part.conditions.end(), [&](const auto& condition) {
               return condition.sign() == area;
           });
}

/// The part before `share` of the interval. Every step of de Casteljau's rounds three times.
Bends<4> before(const Bends<4>& whole, double share) {
    Bends<4> part;
    std::array<double, 4> row = whole.b;
    double largest = 0.0;
    for (const double value : row) {
        largest = std::max(largest, std::abs(value));
    }
    part.b[0] = row[0];
    for (std::size_t level = 1; level < 4; ++level) {
        for (std::size_t i = 0; i + level < 4; ++i) {
            row[i] += share * (row[i + 1] - row[i]);
        }
        part.b[level] = row[0];
    }
    part.error = whole.error + 24.0 * kRounding * largest;
    return part;
}

/// The largest share of the interval for which `holds` is seen to be true, where it is at 0.
template <class Holds>
double largest_share(const Holds& holds) {
    double least = 0.0, most = 1.0;
    constexpr double kNarrow = 0x1p-48;
    while (most - least > kNarrow) {
        const double middle = 0.5 * (least + most);
        (holds(middle) ? least : most) = middle;
    }
    return least;
}

/// Closes in on a simple change of sign by Newton's method, and takes the place if its neighbours
/// prove it. Nothing if they do not.
std::optional<double> newton_change(const Bends<4>& volume, double narrow) {
    const auto& b = volume.b;
    const std::array<double, 3> slopes{
        3.0 * (b[1] - b[0]), 3.0 * (b[2] - b[1]), 3.0 * (b[3] - b[2])};
    double place = b[0] / (b[0] - b[3]);
    double slope = 0.0;
    for (int step = 0; step < 6; ++step) {
        const double rest = 1.0 - place;
        const double value = rest * rest * (rest * b[0] + 3.0 * place * b[1]) +
                             place * place * (3.0 * rest * b[2] + place * b[3]);
        slope = rest * (rest * slopes[0] + 2.0 * place * slopes[1]) + place * place * slopes[2];
        place = std::clamp(place - value / slope, 0.0, 1.0);
    }
    const double room = std::min(narrow, 4.0 * volume.error / std::abs(slope) + 0x1p-46);
    const double without = place - room;
    const double until = place + room;
    const int sign = volume.sign_at_begin();
    // Comparisons that are false for what is not a number.
    if (without >= 0.0 && until <= 1.0 && before(volume, without).sign() == sign &&
        before(volume, until).sign_at_end() == -sign) {
        return without;
    }
    return std::nullopt;
}

/// Not after the first change of sign, and before it by 2^-40 at most. Nothing if rounding hides
/// where that is. Precondition: signs at the ends are certain and differ.
std::optional<double> first_change(Bends<4> volume, double begin, double width) {
    constexpr double kTolerance = 0x1p-40;
    // Halved a few times, or until the sign in the middle is not certain.
    constexpr int kHalvings = 4;
    for (int i = 0; i < kHalvings; ++i) {
        Bends<4> lower, upper;
        halve(volume, lower, upper);
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
    if (const auto without = newton_change(volume, 0.5 * kTolerance / width)) {
        return std::max(begin, begin + *without * width - 0x1p-52);
    }
    const int sign = volume.sign_at_begin();
    const double without =
        largest_share([&](double share) { return before(volume, share).sign() == sign; });
    const double until =
        largest_share([&](double share) { return before(volume, share).sign_at_end() != -sign; });
    if ((until - without) * width > kTolerance) {
        return std::nullopt;
    }
    // The sum is rounded.
    return std::max(begin, begin + without * width - 0x1p-52);
}

Answer decide(const Part& whole) {
    constexpr int kMostParts = 48;
    constexpr std::size_t kDeepest = 16;
    std::array<Part, kDeepest> open;
    std::size_t count = 1;
    open[0] = whole;
    for (int parts = 0; parts < kMostParts && count > 0; ++parts) {
        const Part part = open[--count];
        if (part.volume.sign() != 0) {
            continue;
        }
        const int area = part.area.sign();
        if (conditions_exclude(part, area)) {
            continue;
        }
        if (is_contact(part, area)) {
            const auto time = first_change(part.volume, part.begin, part.width);
            return time ? Answer{Verdict::contact, *time} : Answer{Verdict::unknown};
        }
        if (count + 2 > kDeepest) {
            return {Verdict::unknown};
        }
        Part& upper = open[count];
        Part& lower = open[count + 1];
        halve(part.volume, lower.volume, upper.volume);
        halve(part.area, lower.area, upper.area);
        for (std::size_t i = 0; i < part.conditions.size(); ++i) {
            halve(part.conditions[i], lower.conditions[i], upper.conditions[i]);
        }
        lower.width = upper.width = 0.5 * part.width;
        lower.begin = part.begin;
        upper.begin = part.begin + lower.width;
        count += 2;
    }
    return {count == 0 ? Verdict::none : Verdict::unknown};
}

/// Products of three must neither vanish nor overflow for the bounds to hold.
bool is_in_range(double volume) {
    return volume > 1e-200 && volume < 1e200;
}

int largest_axis(const Vec3& v) {
    const Vec3 size = glm::abs(v);
    return size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
}

/// True if at both ends, and so throughout, all of the first `count` points lie on one side of all
/// others along an axis. No rounding: coordinates are compared.
bool are_apart(const MovingPoints& points, std::size_t count) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto side = [&](const std::array<Vec3, 4>& at) {
            double least = at[0][axis], most = at[0][axis];
            for (std::size_t i = 1; i < count; ++i) {
                least = std::min(least, at[i][axis]);
                most = std::max(most, at[i][axis]);
            }
            double other_least = at[count][axis], other_most = at[count][axis];
            for (std::size_t i = count + 1; i < 4; ++i) {
                other_least = std::min(other_least, at[i][axis]);
                other_most = std::max(other_most, at[i][axis]);
            }
            return most < other_least ? 1 : other_most < least ? -1 : 0;
        };
        const int begin = side(points.begin);
        if (begin != 0 && begin == side(points.end)) {
            return true;
        }
    }
    return false;
}

/// The same along any direction, with room for rounding: a place is within 8 roundings of the
/// largest product. Places count from the last point.
bool are_apart_along(const MovingPoints& points, std::size_t count, const Vec3& direction) {
    const double length = magnitude(direction, direction);
    int side = 0;
    for (const auto* at : {&points.begin, &points.end}) {
        std::array<double, 4> place{};
        double largest = 0.0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 way = (*at)[i] - (*at)[3];
            place[i] = glm::dot(way, direction);
            largest = std::max(largest, magnitude(way, way));
        }
        // The summand stands for products that vanish.
        const double error = 8.0 * kRounding * (3.0 * largest * length) + 1e-300;
        const auto split = place.begin() + static_cast<std::ptrdiff_t>(count);
        const auto [least, most] = std::minmax_element(place.begin(), split);
        const auto [other_least, other_most] = std::minmax_element(split, place.end());
        const int here = *other_least - *most > 2.0 * error   ? 1
                         : *least - *other_most > 2.0 * error ? -1
                                                              : 0;
        if (here == 0 || here == -side) {
            return false;
        }
        side = here;
    }
    return true;
}

/// Directions that keep apart what lies in one plane, or on parallel lines: across the edges and
/// the way between the features, half-way through the step.
bool are_apart_across(const MovingPoints& points, std::size_t count) {
    std::array<Vec3, 4> x;
    for (std::size_t i = 0; i < 4; ++i) {
        x[i] = 0.5 * (points.begin[i] + points.end[i]);
    }
    const Vec3 way = x[count] - x[0];
    const Vec3 one = count == 2 ? x[1] - x[0] : x[2] - x[1];
    const Vec3 two = x[3] - x[2];
    const std::array<Vec3, 5> directions{
        way,
        glm::cross(one, two),
        glm::cross(glm::cross(one, way), one),
        glm::cross(glm::cross(two, way), two),
        count == 2 ? way : glm::cross(glm::cross(x[3] - x[1], way), x[3] - x[1])};
    return std::any_of(directions.begin(), directions.end(), [&](const Vec3& direction) {
        const double length = magnitude(direction, direction);
        return length > 1e-100 && length < 1e100 &&
               are_apart_along(points, count, direction / length);
    });
}

}  // namespace

std::optional<double> vertex_face_ccd(const MovingPoints& points) {
    if (are_apart(points, 1)) {
        return std::nullopt;
    }
    const Way ab(points, 1, 2), ac(points, 1, 3), ap(points, 1, 0);
    Part whole;
    whole.volume = determinant(ab, ac, ap);
    if (is_in_range(ab.most * ac.most * ap.most)) {
        if (whole.volume.sign() != 0) {
            return std::nullopt;
        }
        const int axis = largest_axis(glm::cross(ab.begin + ab.end, ac.begin + ac.end));
        whole.area = cross(ab, ac, axis);
        whole.conditions[0] = cross(ab, ap, axis);
        whole.conditions[1] = cross(ap, ac, axis);
        whole.conditions[2] =
            difference(difference(whole.area, whole.conditions[0]), whole.conditions[1]);
        whole.conditions[3] = whole.conditions[0];
        const Answer answer = decide(whole);
        if (answer.verdict != Verdict::unknown) {
            return answer.verdict == Verdict::contact ? std::optional(answer.time) : std::nullopt;
        }
    }
    if (are_apart_across(points, 1)) {
        return std::nullopt;
    }
    return exact_vertex_face_ccd(integers_of(points));
}

std::optional<double> edge_edge_ccd(const MovingPoints& points) {
    if (are_apart(points, 2)) {
        return std::nullopt;
    }
    const Way ab(points, 0, 1), cd(points, 2, 3), ac(points, 0, 2);
    Part whole;
    whole.volume = determinant(ab, cd, ac);
    if (is_in_range(ab.most * cd.most * ac.most)) {
        if (whole.volume.sign() != 0) {
            return std::nullopt;
        }
        // a + u ab = c + v cd: u = ac x cd / ab x cd, v = ac x ab / ab x cd.
        const int axis = largest_axis(glm::cross(ab.begin + ab.end, cd.begin + cd.end));
        whole.area = cross(ab, cd, axis);
        whole.conditions[0] = cross(ac, cd, axis);
        whole.conditions[1] = difference(whole.area, whole.conditions[0]);
        whole.conditions[2] = cross(ac, ab, axis);
        whole.conditions[3] = difference(whole.area, whole.conditions[2]);
        const Answer answer = decide(whole);
        if (answer.verdict != Verdict::unknown) {
            return answer.verdict == Verdict::contact ? std::optional(answer.time) : std::nullopt;
        }
    }
    if (are_apart_across(points, 2)) {
        return std::nullopt;
    }
    return exact_edge_edge_ccd(integers_of(points));
}

}  // namespace earshot::collision
