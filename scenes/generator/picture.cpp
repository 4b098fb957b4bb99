// SPDX-License-Identifier: MIT
#include "earshot/scenes/picture.h"

#include "earshot/base/math.h"
#include "earshot/io/svg.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace earshot::scenes {

namespace {

constexpr int kWidth = 900;  // of the drawing, in its units
constexpr int kMargin = 20;
constexpr double kShortest = 4.0;  // edges shorter than this are left out
constexpr int kBuffer = 2;         // cells of the depth buffer per unit
// An edge lies in its own faces. It is drawn where nothing lies nearer by more than a cell of the
// depth buffer can differ along the steepest face that is still drawn.
constexpr double kDepthSlack = 6.0;
constexpr double kGrazing = 0.02;  // cosine to the view below which a face is not drawn

// A point of the drawing: x to the right, y down, depth towards the viewer; all in its units.
struct Drawn {
    double x = 0.0, y = 0.0, depth = 0.0;
};

struct WorldFace {
    std::vector<Vec3> corners;
    Vec3 normal{0.0};
    std::size_t material = 0;
};

// A vector times `rotation`, written out: quaternion products of libraries may round otherwise.
Vec3 turned(const glm::dquat& rotation, const Vec3& vector) {
    const Vec3 axis(rotation.x, rotation.y, rotation.z);
    const Vec3 twist = glm::cross(axis, vector) + vector * rotation.w;
    return vector + glm::cross(axis, twist) * 2.0;
}

Vec3 posed(const DraftNode& node, const Vec3& rest) {
    Vec3 at = rest;
    if (!node.weights.times.empty()) {
        const auto& weights = node.weights.weights[node.weights.weights.size() / 2];
        for (std::size_t target = 0; target < node.morphs.size(); ++target) {
            at += node.morphs[target](rest) * weights[target];
        }
    }
    if (!node.rotation.times.empty()) {
        at = turned(node.rotation.rotations[node.rotation.rotations.size() / 2], at);
    }
    return at + node.translation;
}

// A view from above, from the right and the front; x runs to the right, z to the left and towards
// us.
class View {
public:
    explicit View(const SceneDraft& draft) {
        const double turn = 0.62;  // radians about the vertical
        const double tilt = 0.60;  // radians below the horizon
        right_ = {math::cos(turn), 0.0, -math::sin(turn)};
        towards_ = {
            math::sin(turn) * math::cos(tilt), math::sin(tilt), math::cos(turn) * math::cos(tilt)};
        up_ = glm::cross(towards_, right_);
        Vec3 low(std::numeric_limits<double>::max());
        Vec3 high(std::numeric_limits<double>::lowest());
        for (const DraftNode& node : draft.nodes) {
            for (const Face& face : node.faces) {
                for (std::size_t i = 0; i < face.corner_count; ++i) {
                    const Vec3 at = posed(node, face.corners[i]);
                    const Vec3 seen(
                        glm::dot(at, right_), glm::dot(at, up_), glm::dot(at, towards_));
                    for (int axis = 0; axis < 3; ++axis) {
                        low[axis] = std::min(low[axis], seen[axis]);
                        high[axis] = std::max(high[axis], seen[axis]);
                    }
                }
            }
        }
        left_ = low.x;
        top_ = high.y;
        scale_ = (kWidth - 2 * kMargin) / (high.x - low.x);
        height_ = static_cast<int>((high.y - low.y) * scale_) + 2 * kMargin + 1;
    }

    Drawn draw(const Vec3& at) const {
        return {(glm::dot(at, right_) - left_) * scale_ + kMargin,
                (top_ - glm::dot(at, up_)) * scale_ + kMargin,
                glm::dot(at, towards_) * scale_};
    }

    /// Cosine between a unit normal and the direction to the viewer.
    double facing(const Vec3& normal) const { return glm::dot(normal, towards_); }
    int height() const { return height_; }

private:
    Vec3 right_{0.0}, up_{0.0}, towards_{0.0};
    double left_ = 0.0, top_ = 0.0, scale_ = 1.0;
    int height_ = 0;
};

std::vector<WorldFace> faces_towards(const SceneDraft& draft, const View& view) {
    std::vector<WorldFace> faces;
    for (const DraftNode& node : draft.nodes) {
        for (const Face& face : node.faces) {
            if (!draft.materials[face.material].in_picture) {
                continue;
            }
            WorldFace seen;
            seen.material = face.material;
            for (std::size_t i = 0; i < face.corner_count; ++i) {
                seen.corners.push_back(posed(node, face.corners[i]));
            }
            const Vec3 area =
                glm::cross(seen.corners[1] - seen.corners[0], seen.corners[2] - seen.corners[0]);
            const double length = std::sqrt(glm::dot(area, area));
            if (length > 0.0) {
                seen.normal = area / length;
                if (view.facing(seen.normal) > kGrazing) {
                    faces.push_back(std::move(seen));
                }
            }
        }
    }
    return faces;
}

// The nearest depth per cell.
class DepthBuffer {
public:
    explicit DepthBuffer(int height)
        : columns_(kWidth * kBuffer),
          rows_(height * kBuffer),
          depth_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_),
                 std::numeric_limits<double>::lowest()) {}

    void fill(const Drawn& a, const Drawn& b, const Drawn& c) {
        const double area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
        if (area == 0.0) {
            return;
        }
        const int first_row = row_of(std::min({a.y, b.y, c.y}));
        const int last_row = row_of(std::max({a.y, b.y, c.y}));
        const int first_column = column_of(std::min({a.x, b.x, c.x}));
        const int last_column = column_of(std::max({a.x, b.x, c.x}));
        for (int row = first_row; row <= last_row; ++row) {
            for (int column = first_column; column <= last_column; ++column) {
                const double x = (column + 0.5) / kBuffer;
                const double y = (row + 0.5) / kBuffer;
                const double v = ((x - a.x) * (c.y - a.y) - (y - a.y) * (c.x - a.x)) / area;
                const double w = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
                if (v >= 0.0 && w >= 0.0 && v + w <= 1.0) {
                    double& cell = depth_[index(column, row)];
                    cell =
                        std::max(cell, a.depth + v * (b.depth - a.depth) + w * (c.depth - a.depth));
                }
            }
        }
    }

    bool hides(const Drawn& point) const {
        return depth_[index(column_of(point.x), row_of(point.y))] > point.depth + kDepthSlack;
    }

private:
    int column_of(double x) const {
        return std::clamp(static_cast<int>(std::floor(x * kBuffer)), 0, columns_ - 1);
    }
    int row_of(double y) const {
        return std::clamp(static_cast<int>(std::floor(y * kBuffer)), 0, rows_ - 1);
    }
    std::size_t index(int column, int row) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(column);
    }

    int columns_, rows_;
    std::vector<double> depth_;
};

using Ends = std::pair<std::array<double, 3>, std::array<double, 3>>;

// Edges of the faces by their ends (the smaller first), each with the faces beside it.
std::map<Ends, std::vector<const WorldFace*>> edges_of(const std::vector<WorldFace>& faces) {
    std::map<Ends, std::vector<const WorldFace*>> edges;
    for (const WorldFace& face : faces) {
        for (std::size_t i = 0; i < face.corners.size(); ++i) {
            const Vec3& a = face.corners[i];
            const Vec3& b = face.corners[(i + 1) % face.corners.size()];
            std::array<double, 3> from = {a.x, a.y, a.z};
            std::array<double, 3> to = {b.x, b.y, b.z};
            if (to < from) {
                std::swap(from, to);
            }
            edges[{from, to}].push_back(&face);
        }
    }
    return edges;
}

// Two faces go on smoothly into each other: their common edge is only a seam.
bool is_seam(const std::vector<const WorldFace*>& beside) {
    constexpr double kSmooth = 0.999;  // cosine; 2.6 degrees
    return beside.size() == 2 && beside[0]->material == beside[1]->material &&
           glm::dot(beside[0]->normal, beside[1]->normal) > kSmooth;
}

std::string whole(double number) {
    return std::to_string(static_cast<int>(std::lround(number)));
}

// A point of the drawing without its depth, rounded to its units.
io::SvgPoint flat(const Drawn& point) {
    return {std::round(point.x), std::round(point.y)};
}

// Appends the visible stretches of an edge.
void append_visible(const Drawn& from,
                    const Drawn& to,
                    const DepthBuffer& buffer,
                    std::vector<std::vector<io::SvgPoint>>& lines) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    if (length < kShortest) {
        return;
    }
    const int steps = static_cast<int>(length) + 1;
    const auto at = [&](int step) {
        const double t = static_cast<double>(step) / steps;
        return Drawn{from.x + (to.x - from.x) * t,
                     from.y + (to.y - from.y) * t,
                     from.depth + (to.depth - from.depth) * t};
    };
    int start = -1;
    for (int step = 0; step <= steps + 1; ++step) {
        const bool shown = step <= steps && !buffer.hides(at(step));
        if (shown && start < 0) {
            start = step;
        } else if (!shown && start >= 0) {
            if (step - 1 - start >= kShortest) {
                lines.push_back({flat(at(start)), flat(at(step - 1))});
            }
            start = -1;
        }
    }
}

// A stroke dark enough for white paper.
std::string stroke(const std::array<double, 3>& colour) {
    std::string text = "rgb(";
    for (std::size_t i = 0; i < 3; ++i) {
        text += whole(30.0 + 150.0 * std::sqrt(colour[i]) * colour[i]) + (i < 2 ? "," : ")");
    }
    return text;
}

// Where the labels of the emitters go: beside their dots, but not onto an earlier label.
std::vector<Drawn> label_places(const std::vector<Drawn>& dots) {
    constexpr double kLabelWidth = 110.0;
    constexpr double kLineHeight = 14.0;
    std::vector<Drawn> places;
    for (const Drawn& dot : dots) {
        Drawn place{dot.x + 8.0, dot.y + 4.0, 0.0};
        const auto covered = [&](const Drawn& other) {
            return std::fabs(other.x - place.x) < kLabelWidth &&
                   std::fabs(other.y - place.y) < kLineHeight;
        };
        while (std::any_of(places.begin(), places.end(), covered)) {
            place.y += 1.0;
        }
        places.push_back(place);
    }
    return places;
}

void draw_emitters(const SceneDraft& draft, const View& view, io::SvgPicture& picture) {
    std::vector<const DraftNode*> nodes;
    std::vector<Drawn> dots;
    for (const DraftNode& node : draft.nodes) {
        if (node.role != Role::none) {
            nodes.push_back(&node);
            dots.push_back(view.draw(node.translation));
        }
    }
    const std::vector<Drawn> labels = label_places(dots);
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const char* colour = nodes[i]->role == Role::source ? "#c1121f" : "#1d4ed8";
        picture.disc(flat(dots[i]), 5.0, colour);
        picture.text(flat(labels[i]), nodes[i]->name, {.fill = colour, .halo = true});
    }
}

}  // namespace

std::string draw_picture(const SceneDraft& draft) {
    const View view(draft);
    const std::vector<WorldFace> faces = faces_towards(draft, view);
    DepthBuffer buffer(view.height());
    for (const WorldFace& face : faces) {
        for (std::size_t i = 2; i < face.corners.size(); ++i) {
            buffer.fill(view.draw(face.corners[0]),
                        view.draw(face.corners[i - 1]),
                        view.draw(face.corners[i]));
        }
    }

    std::vector<std::vector<std::vector<io::SvgPoint>>> lines(draft.materials.size());
    for (const auto& [ends, beside] : edges_of(faces)) {
        if (!is_seam(beside)) {
            const auto& [from, to] = ends;
            append_visible(view.draw({from[0], from[1], from[2]}),
                           view.draw({to[0], to[1], to[2]}),
                           buffer,
                           lines[beside.back()->material]);
        }
    }

    io::SvgPicture picture(kWidth, view.height(), 13.0, draft.name);
    for (std::size_t material = 0; material < lines.size(); ++material) {
        picture.polylines(lines[material], stroke(draft.materials[material].colour));
    }
    draw_emitters(draft, view, picture);
    return picture.str();
}

}  // namespace earshot::scenes
