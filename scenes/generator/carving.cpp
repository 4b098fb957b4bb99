// SPDX-License-Identifier: MIT
#include "earshot/scenes/carving.h"

#include "earshot/scenes/tick_grid.h"

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

namespace earshot::scenes {

namespace {

using Ticks = std::array<std::int64_t, 3>;
using Cell = std::array<std::size_t, 3>;

Ticks to_ticks(const Vec3& point) {
    return {ticks(point.x), ticks(point.y), ticks(point.z)};
}

using Node = std::array<std::size_t, 2>;  // of the grid, in a plane

// One side of one cell of the grid, on the plane between rock and air.
struct Tile {
    std::size_t axis = 0;  // of the normal
    bool positive = true;  // looks along +axis
    std::size_t plane = 0;
    std::size_t u = 0, v = 0;  // cell in the plane; u = axis + 1, v = axis + 2 (cyclic)
    std::size_t material = 0;
    std::vector<bool> halves;  // on which side of each division
};

// Tiles that may grow into one polygon.
using TileKey = std::tuple<std::size_t, bool, std::size_t, std::size_t, std::vector<bool>>;

// Tiles of one patch, and the corners of its border: loops of grid nodes.
struct Patch {
    std::size_t axis = 0;
    bool positive = true;
    std::size_t plane = 0;
    std::size_t material = 0;
    std::vector<std::vector<Node>> loops;
};

// Where one can go from each node along the border, with the tiles on the left.
std::map<Node, std::vector<Node>> border_steps(const std::set<Node>& tiles) {
    std::map<Node, std::vector<Node>> next;
    const auto has = [&](std::size_t u, std::size_t v) { return tiles.count({u, v}) != 0; };
    for (const auto& [u, v] : tiles) {
        if (v == 0 || !has(u, v - 1)) {
            next[{u, v}].push_back({u + 1, v});
        }
        if (!has(u + 1, v)) {
            next[{u + 1, v}].push_back({u + 1, v + 1});
        }
        if (!has(u, v + 1)) {
            next[{u + 1, v + 1}].push_back({u, v + 1});
        }
        if (u == 0 || !has(u - 1, v)) {
            next[{u, v + 1}].push_back({u, v});
        }
    }
    return next;
}

// Positive if the way a, b, c turns left, negative if it turns right.
std::int64_t turn(const Node& a, const Node& b, const Node& c) {
    const auto difference = [](std::size_t from, std::size_t to) {
        return static_cast<std::int64_t>(to) - static_cast<std::int64_t>(from);
    };
    return difference(a[0], b[0]) * difference(b[1], c[1]) -
           difference(a[1], b[1]) * difference(b[0], c[0]);
}

// The border of a set of tiles as closed loops. Where two tiles touch at a corner only, the loop
// turns left and so stays with its tile.
std::vector<std::vector<Node>> border(const std::set<Node>& tiles) {
    std::map<Node, std::vector<Node>> next = border_steps(tiles);
    std::vector<std::vector<Node>> loops;
    while (!next.empty()) {
        std::vector<Node> loop = {next.begin()->first};
        Node before = loop.front();
        Node at = loop.front();
        do {
            auto& choices = next[at];
            const auto leftmost =
                std::max_element(choices.begin(), choices.end(), [&](const Node& a, const Node& b) {
                    return turn(before, at, a) < turn(before, at, b);
                });
            before = at;
            at = *leftmost;
            choices.erase(leftmost);
            if (choices.empty()) {
                next.erase(before);
            }
            loop.push_back(at);
        } while (at != loop.front());
        loop.pop_back();
        loops.push_back(std::move(loop));
    }
    return loops;
}

}  // namespace

// The steps from boxes to faces; lives as long as one call of Carving::surface.
class CarvedSurface {
public:
    explicit CarvedSurface(const Carving& carving) : carving_(carving) {
        lay_grid();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            collect_tiles(axis);
        }
        join_tiles();
        find_corners();
    }

    Faces faces() const {
        Faces result;
        for (const Patch& patch : patches_) {
            fill_patch(patch, result);
        }
        return result;
    }

private:
    void lay_grid() {
        std::array<std::set<std::int64_t>, 3> planes;
        const auto note = [&](const Box& box) {
            const Ticks low = to_ticks(box.low);
            const Ticks high = to_ticks(box.high);
            for (std::size_t axis = 0; axis < 3; ++axis) {
                planes[axis].insert({low[axis], high[axis]});
            }
        };
        for (const auto& step : carving_.steps_) {
            note(step.box);
        }
        for (const auto& paint : carving_.paints_) {
            note(paint.region);
        }
        for (const auto& division : carving_.divisions_) {
            planes[static_cast<std::size_t>(division.axis)].insert(ticks(division.at));
        }
        for (std::size_t axis = 0; axis < 3; ++axis) {
            planes_[axis].assign(planes[axis].begin(), planes[axis].end());
        }
        mark_air();
    }

    void mark_air() {
        const std::size_t nx = planes_[0].size() - 1;
        const std::size_t ny = planes_[1].size() - 1;
        const std::size_t nz = planes_[2].size() - 1;
        air_.assign(nx * ny * nz, false);
        for (const auto& step : carving_.steps_) {
            const Cell low = cell_at(to_ticks(step.box.low));
            const Cell high = cell_at(to_ticks(step.box.high));
            for (std::size_t x = low[0]; x < high[0]; ++x) {
                for (std::size_t y = low[1]; y < high[1]; ++y) {
                    for (std::size_t z = low[2]; z < high[2]; ++z) {
                        air_[(x * ny + y) * nz + z] = step.air;
                    }
                }
            }
        }
    }

    Cell cell_at(const Ticks& point) const {
        Cell cell{};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            cell[axis] = static_cast<std::size_t>(
                std::lower_bound(planes_[axis].begin(), planes_[axis].end(), point[axis]) -
                planes_[axis].begin());
        }
        return cell;
    }

    // Outside the grid is rock.
    bool is_air(const Cell& cell) const {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            if (cell[axis] >= planes_[axis].size() - 1) {
                return false;
            }
        }
        const std::size_t ny = planes_[1].size() - 1;
        const std::size_t nz = planes_[2].size() - 1;
        return air_[(cell[0] * ny + cell[1]) * nz + cell[2]];
    }

    void collect_tiles(std::size_t axis) {
        const std::size_t u_axis = (axis + 1) % 3;
        const std::size_t v_axis = (axis + 2) % 3;
        for (std::size_t plane = 0; plane < planes_[axis].size(); ++plane) {
            for (std::size_t u = 0; u + 1 < planes_[u_axis].size(); ++u) {
                for (std::size_t v = 0; v + 1 < planes_[v_axis].size(); ++v) {
                    Cell above{};
                    above[axis] = plane;
                    above[u_axis] = u;
                    above[v_axis] = v;
                    Cell below = above;
                    const bool air_above = is_air(above);
                    const bool air_below = plane > 0 && (--below[axis], is_air(below));
                    if (air_above != air_below) {
                        add_tile({axis, air_above, plane, u, v, 0, {}});
                    }
                }
            }
        }
    }

    void add_tile(Tile tile) {
        // Twice the centre, so that it stays whole.
        Ticks centre{};
        const std::size_t u_axis = (tile.axis + 1) % 3;
        const std::size_t v_axis = (tile.axis + 2) % 3;
        centre[tile.axis] = 2 * planes_[tile.axis][tile.plane];
        centre[u_axis] = planes_[u_axis][tile.u] + planes_[u_axis][tile.u + 1];
        centre[v_axis] = planes_[v_axis][tile.v] + planes_[v_axis][tile.v + 1];

        tile.material = carving_.material_;
        const auto facing =
            static_cast<Facing>(1 + 2 * static_cast<int>(tile.axis) + (tile.positive ? 1 : 0));
        for (const auto& paint : carving_.paints_) {
            const Ticks low = to_ticks(paint.region.low);
            const Ticks high = to_ticks(paint.region.high);
            bool covered = paint.facing == Facing::any || paint.facing == facing;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                covered =
                    covered && 2 * low[axis] <= centre[axis] && centre[axis] <= 2 * high[axis];
            }
            if (covered) {
                tile.material = paint.material;
            }
        }
        for (const auto& division : carving_.divisions_) {
            tile.halves.push_back(centre[static_cast<std::size_t>(division.axis)] <
                                  2 * ticks(division.at));
        }
        const TileKey key(tile.axis, tile.positive, tile.plane, tile.material, tile.halves);
        tiles_[key].insert({tile.u, tile.v});
    }

    // Neighbouring tiles of one kind become patches.
    void join_tiles() {
        for (auto& [key, rest] : tiles_) {
            while (!rest.empty()) {
                std::set<Node> members;
                std::vector<Node> open = {*rest.begin()};
                rest.erase(rest.begin());
                while (!open.empty()) {
                    const Node tile = open.back();
                    open.pop_back();
                    members.insert(tile);
                    const auto [u, v] = tile;
                    for (const Node neighbour :
                         {Node{u + 1, v}, Node{u - 1, v}, Node{u, v + 1}, Node{u, v - 1}}) {
                        if (rest.erase(neighbour) != 0) {
                            open.push_back(neighbour);
                        }
                    }
                }
                patches_.push_back({std::get<0>(key),
                                    std::get<1>(key),
                                    std::get<2>(key),
                                    std::get<3>(key),
                                    border(members)});
            }
        }
    }

    Cell grid_node(const Patch& patch, const Node& node) const {
        Cell at{};
        at[patch.axis] = patch.plane;
        at[(patch.axis + 1) % 3] = node[0];
        at[(patch.axis + 2) % 3] = node[1];
        return at;
    }

    // A node of the grid is a corner if any border turns there; then every polygon that passes
    // uses it, which is what rules out T-junctions.
    void find_corners() {
        for (const Patch& patch : patches_) {
            for (const auto& loop : patch.loops) {
                for (std::size_t i = 0; i < loop.size(); ++i) {
                    const Node& before = loop[(i + loop.size() - 1) % loop.size()];
                    const Node& after = loop[(i + 1) % loop.size()];
                    if (before[0] != after[0] && before[1] != after[1]) {
                        corners_.insert(grid_node(patch, loop[i]));
                    }
                }
            }
        }
    }

    // The borders of a patch by their corners, the outline first.
    std::vector<std::vector<GridPoint>> cornered_loops(const Patch& patch) const {
        const auto& u_planes = planes_[(patch.axis + 1) % 3];
        const auto& v_planes = planes_[(patch.axis + 2) % 3];
        std::vector<std::vector<GridPoint>> loops;
        for (const auto& nodes : patch.loops) {
            std::vector<GridPoint> loop;
            for (const Node& node : nodes) {
                if (corners_.count(grid_node(patch, node)) != 0) {
                    loop.push_back({u_planes[node[0]], v_planes[node[1]]});
                }
            }
            loops.push_back(std::move(loop));
        }
        std::stable_partition(
            loops.begin(), loops.end(), [](const auto& loop) { return doubled_area(loop) > 0; });
        return loops;
    }

    Vec3 point_of(const Patch& patch, const GridPoint& at) const {
        const auto metres = [](std::int64_t t) { return static_cast<double>(t) / kTicksPerMetre; };
        Vec3 point{0.0};
        point[static_cast<int>(patch.axis)] = metres(planes_[patch.axis][patch.plane]);
        point[static_cast<int>((patch.axis + 1) % 3)] = metres(at.u);
        point[static_cast<int>((patch.axis + 2) % 3)] = metres(at.v);
        return point;
    }

    // `corners` run counter-clockwise seen against the axis.
    Face face_of(const Patch& patch, std::vector<GridPoint> corners) const {
        if (!patch.positive) {
            std::reverse(corners.begin(), corners.end());
        }
        Face face;
        face.corner_count = corners.size();
        face.material = patch.material;
        std::transform(corners.begin(), corners.end(), face.corners.begin(), [&](const auto& at) {
            return point_of(patch, at);
        });
        return face;
    }

    void fill_patch(const Patch& patch, Faces& faces) const {
        std::vector<std::vector<GridPoint>> loops = cornered_loops(patch);
        if (loops.size() == 1 && loops.front().size() == 4) {
            faces.push_back(face_of(patch, loops.front()));
            return;
        }
        for (const auto& [a, b, c] : triangulate(loops)) {
            faces.push_back(face_of(patch, {a, b, c}));
        }
    }

    const Carving& carving_;
    std::array<std::vector<std::int64_t>, 3> planes_;
    std::vector<bool> air_;
    std::map<TileKey, std::set<Node>> tiles_;
    std::vector<Patch> patches_;
    std::set<Cell> corners_;
};

Faces Carving::surface() const {
    return CarvedSurface(*this).faces();
}

}  // namespace earshot::scenes
