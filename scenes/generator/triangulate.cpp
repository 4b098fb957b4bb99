// SPDX-License-Identifier: MIT
#include "earshot/scenes/triangulate.h"

#include "earshot/base/assert.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace earshot::scenes {

namespace {

using Loop = std::vector<GridPoint>;

std::int64_t distance_squared(const GridPoint& a, const GridPoint& b) {
    return (a.u - b.u) * (a.u - b.u) + (a.v - b.v) * (a.v - b.v);
}

int side(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    const std::int64_t area = doubled_area(a, b, c);
    return area > 0 ? 1 : area < 0 ? -1 : 0;
}

// `c`, on the line through a and b, lies strictly between them.
bool strictly_between(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    return c != a && c != b && std::min(a.u, b.u) <= c.u && c.u <= std::max(a.u, b.u) &&
           std::min(a.v, b.v) <= c.v && c.v <= std::max(a.v, b.v);
}

// The segments have a point in common other than shared ends.
bool meet(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& d) {
    const int abc = side(a, b, c);
    const int abd = side(a, b, d);
    const int cda = side(c, d, a);
    const int cdb = side(c, d, b);
    if (abc * abd < 0 && cda * cdb < 0) {
        return true;
    }
    return (abc == 0 && strictly_between(a, b, c)) || (abd == 0 && strictly_between(a, b, d)) ||
           (cda == 0 && strictly_between(c, d, a)) || (cdb == 0 && strictly_between(c, d, b));
}

bool meets_any(const GridPoint& a, const GridPoint& b, const std::vector<Loop>& loops) {
    for (const Loop& loop : loops) {
        for (std::size_t i = 0; i < loop.size(); ++i) {
            if (meet(a, b, loop[i], loop[(i + 1) % loop.size()])) {
                return true;
            }
        }
    }
    return false;
}

// Joins the last loop to the first by the shortest bridge that crosses nothing.
void bridge_last(std::vector<Loop>& loops) {
    const Loop hole = loops.back();
    Loop& outline = loops.front();
    std::size_t from = 0;
    std::size_t to = 0;
    std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
    for (std::size_t i = 0; i < outline.size(); ++i) {
        for (std::size_t j = 0; j < hole.size(); ++j) {
            const std::int64_t length = distance_squared(outline[i], hole[j]);
            if (length < shortest && !meets_any(outline[i], hole[j], loops)) {
                shortest = length;
                from = i;
                to = j;
            }
        }
    }
    EARSHOT_ASSERT(shortest != std::numeric_limits<std::int64_t>::max());
    Loop detour;
    for (std::size_t j = 0; j <= hole.size(); ++j) {
        detour.push_back(hole[(to + j) % hole.size()]);
    }
    detour.push_back(outline[from]);
    outline.insert(
        outline.begin() + static_cast<std::ptrdiff_t>(from) + 1, detour.begin(), detour.end());
    loops.pop_back();
}

bool inside_or_on(const GridPoint& a,
                  const GridPoint& b,
                  const GridPoint& c,
                  const GridPoint& point) {
    return side(a, b, point) >= 0 && side(b, c, point) >= 0 && side(c, a, point) >= 0;
}

// The corner at `i` can be cut off: it is convex and no other corner lies in the triangle. Corners
// that coincide with its ends (the two sides of a bridge) do not hinder.
bool is_ear(const Loop& loop, std::size_t i) {
    const std::size_t count = loop.size();
    const GridPoint& a = loop[(i + count - 1) % count];
    const GridPoint& b = loop[i];
    const GridPoint& c = loop[(i + 1) % count];
    if (side(a, b, c) <= 0) {
        return false;
    }
    return std::none_of(loop.begin(), loop.end(), [&](const GridPoint& point) {
        return point != a && point != b && point != c && inside_or_on(a, b, c, point);
    });
}

}  // namespace

std::int64_t ticks(double metres) {
    return std::llround(metres * kTicksPerMetre);
}

std::int64_t doubled_area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

std::int64_t doubled_area(const std::vector<GridPoint>& loop) {
    std::int64_t area = 0;
    for (std::size_t i = 0; i < loop.size(); ++i) {
        const GridPoint& next = loop[(i + 1) % loop.size()];
        area += loop[i].u * next.v - loop[i].v * next.u;
    }
    return area;
}

std::vector<std::array<GridPoint, 3>> triangulate(std::vector<std::vector<GridPoint>> loops) {
    // Holes first become part of the outline. The nearest to the left go first, so that a bridge
    // to a farther one may start at them.
    const auto leftmost = [](const Loop& loop) {
        return std::min_element(loop.begin(),
                                loop.end(),
                                [](const GridPoint& a, const GridPoint& b) { return a.u < b.u; })
            ->u;
    };
    std::stable_sort(loops.begin() + 1, loops.end(), [&](const Loop& a, const Loop& b) {
        return leftmost(a) > leftmost(b);
    });
    while (loops.size() > 1) {
        bridge_last(loops);
    }

    // Ear clipping; the ear with the shortest cut goes first, which keeps slivers rare.
    Loop loop = loops.front();
    std::vector<std::array<GridPoint, 3>> triangles;
    while (loop.size() > 3) {
        const std::size_t count = loop.size();
        std::size_t best = count;
        std::int64_t shortest = std::numeric_limits<std::int64_t>::max();
        for (std::size_t i = 0; i < count; ++i) {
            const std::int64_t cut =
                distance_squared(loop[(i + count - 1) % count], loop[(i + 1) % count]);
            if (cut < shortest && is_ear(loop, i)) {
                shortest = cut;
                best = i;
            }
        }
        EARSHOT_ASSERT(best < count);
        triangles.push_back(
            {loop[(best + count - 1) % count], loop[best], loop[(best + 1) % count]});
        loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(best));
    }
    triangles.push_back({loop[0], loop[1], loop[2]});
    return triangles;
}

}  // namespace earshot::scenes
