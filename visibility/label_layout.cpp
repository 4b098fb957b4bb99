// SPDX-License-Identifier: MIT
#include "earshot/visibility/label_layout.h"

#include "earshot/base/assert.h"
#include "earshot/base/math.h"
#include "earshot/geometry/predicates.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::visibility {
namespace {

using glm::dvec2;

double distance(const dvec2& a, const dvec2& b) noexcept {
    return std::sqrt(glm::dot(a - b, a - b));
}

/// One side of the interior area: x, times -1 on the right, as a convex function of y.
class Side {
public:
    Side(std::vector<dvec2> points, bool is_left) : sign_(is_left ? 1.0 : -1.0) {
        for (dvec2& point : points) {
            point.x *= sign_;
        }
        std::sort(points.begin(), points.end(), [](const dvec2& a, const dvec2& b) {
            return a.y != b.y ? a.y < b.y : a.x < b.x;
        });
        // Andrew 1979: the lower hull, along y.
        for (const dvec2& point : points) {
            if (!hull_.empty() && hull_.back().y == point.y) {
                continue;
            }
            while (hull_.size() > 1 && !is_convex(hull_[hull_.size() - 2], hull_.back(), point)) {
                hull_.pop_back();
            }
            hull_.push_back(point);
        }
    }

    /// x of the boundary; beyond the first and the last row as there.
    double x(double y) const noexcept { return sign_ * value(y); }

    /// x of the line outside of which no row from `first` to `last` has interior area.
    double clear_x(double first, double last) const noexcept {
        double result = std::min(value(first), value(last));
        for (const dvec2& point : hull_) {
            if (point.y > first && point.y < last) {
                result = std::min(result, point.x);
            }
        }
        return sign_ * result;
    }

    double top() const noexcept { return hull_.front().y; }
    double bottom() const noexcept { return hull_.back().y; }

private:
    static bool is_convex(const dvec2& a, const dvec2& b, const dvec2& c) noexcept {
        return (b.x - a.x) * (c.y - a.y) < (c.x - a.x) * (b.y - a.y);
    }

    double value(double y) const noexcept {
        const auto next =
            std::upper_bound(hull_.begin(), hull_.end(), y, [](double at, const dvec2& point) {
                return at < point.y;
            });
        if (next == hull_.begin() || next == hull_.end()) {
            return next == hull_.begin() ? hull_.front().x : hull_.back().x;
        }
        const dvec2& a = *(next - 1);
        return a.x + (next->x - a.x) * ((y - a.y) / (next->y - a.y));
    }

    double sign_;
    std::vector<dvec2> hull_;
};

/// The interior area: the convex hull of the drawing with its margin.
class Interior {
public:
    explicit Interior(std::vector<dvec2> points)
        : points_(std::move(points)), left_(points_, true), right_(points_, false) {}

    const Side& side(bool is_left) const noexcept { return is_left ? left_ : right_; }

    double diagonal() const noexcept {
        dvec2 low = points_.front(), high = points_.front();
        for (const dvec2& point : points_) {
            low = glm::min(low, point);
            high = glm::max(high, point);
        }
        return distance(low, high);
    }

    /// Grows until rows from `first` to `last` have interior area.
    void include_rows(double first, double last) {
        const double top = left_.top(), bottom = left_.bottom();
        if (first < top) {
            points_.emplace_back((left_.x(top) + right_.x(top)) / 2.0, first);
        }
        if (last > bottom) {
            points_.emplace_back((left_.x(bottom) + right_.x(bottom)) / 2.0, last);
        }
        left_ = Side(points_, true);
        right_ = Side(points_, false);
    }

private:
    std::vector<dvec2> points_;
    Side left_, right_;
};

/// Corners whose convex hull is the interior area.
std::vector<dvec2> interior_points(const IdImage& image,
                                   std::span<const LabelledObject> objects,
                                   double margin) {
    std::vector<dvec2> points;
    const auto add = [&](double left, double top, double right, double bottom) {
        points.insert(points.end(),
                      {{left - margin, top - margin},
                       {left - margin, bottom + margin},
                       {right + margin, top - margin},
                       {right + margin, bottom + margin}});
    };
    for (std::size_t row = 0; row < image.height; ++row) {
        const auto begin = image.objects.begin() + static_cast<std::ptrdiff_t>(row * image.width);
        const auto end = begin + static_cast<std::ptrdiff_t>(image.width);
        const auto is_drawing = [](std::uint32_t object) { return object != kBackground; };
        const auto first = std::find_if(begin, end, is_drawing);
        if (first != end) {
            auto last = end - 1;
            while (!is_drawing(*last)) {
                --last;
            }
            const auto top = static_cast<double>(row);
            add(static_cast<double>(first - begin),
                top,
                static_cast<double>(last - begin) + 1.0,
                top + 1.0);
        }
    }
    for (const LabelledObject& object : objects) {
        if (object.anchor) {
            add(object.anchor->x, object.anchor->y, object.anchor->x, object.anchor->y);
        }
    }
    return points;
}

/// A leader line that an object may get.
struct Candidate {
    dvec2 anchor{0.0}, end{0.0};
    double salience = 1.0;  // distance from the outline of the area, pixels; of a fixed anchor 1
    double feasibility = 1.0;
    bool is_left = false;
};

using Candidates = std::vector<Candidate>;

/// Squared distances from each place of a row to the nearest zero of a sampled function plus its
/// value, Felzenszwalb and Huttenlocher 2012: the lower envelope of parabolas. Whole numbers.
class RowTransform {
public:
    void run(std::vector<double>& values) {
        const std::size_t n = values.size();
        vertices_.assign(n, 0);
        bounds_.assign(n + 1, 0.0);
        std::size_t last = 0;
        bounds_[0] = -std::numeric_limits<double>::infinity();
        bounds_[1] = std::numeric_limits<double>::infinity();
        const auto crossing = [&](std::size_t q, std::size_t p) {
            const auto x = static_cast<double>(q), y = static_cast<double>(p);
            return ((values[q] + x * x) - (values[p] + y * y)) / (2.0 * (x - y));
        };
        for (std::size_t q = 1; q < n; ++q) {
            while (crossing(q, vertices_[last]) <= bounds_[last]) {
                --last;
            }
            bounds_[last + 1] = crossing(q, vertices_[last]);
            vertices_[++last] = q;
            bounds_[last + 1] = std::numeric_limits<double>::infinity();
        }
        result_.resize(n);
        std::size_t k = 0;
        for (std::size_t q = 0; q < n; ++q) {
            while (bounds_[k + 1] < static_cast<double>(q)) {
                ++k;
            }
            const double offset = static_cast<double>(q) - static_cast<double>(vertices_[k]);
            result_[q] = offset * offset + values[vertices_[k]];
        }
        values = result_;
    }

private:
    std::vector<std::size_t> vertices_;
    std::vector<double> bounds_, result_;
};

/// The part of an image that holds an object, with a frame of pixels that do not belong to it.
class Area {
public:
    Area(const IdImage& image, std::uint32_t object, std::span<const std::size_t> pixels)
        : left_(image.width), top_(pixels.front() / image.width) {
        std::size_t right = 0;
        for (const std::size_t pixel : pixels) {
            left_ = std::min(left_, pixel % image.width);
            right = std::max(right, pixel % image.width);
        }
        columns_ = right - left_ + 3;
        rows_ = pixels.back() / image.width - top_ + 3;
        // Larger than any squared distance, and small enough for exact sums.
        const double far = 4.0 * static_cast<double>(columns_ * columns_ + rows_ * rows_);
        squared_.assign(columns_ * rows_, 0.0);
        for (const std::size_t pixel : pixels) {
            EARSHOT_ASSERT(image.objects[pixel] == object);
            squared_[index(pixel, image.width)] = far;
        }
        transform();
    }

    /// From the middle of a pixel of the object to that of the nearest one outside.
    double distance_outside(std::size_t pixel, std::size_t image_width) const noexcept {
        return std::sqrt(squared_[index(pixel, image_width)]);
    }

private:
    std::size_t index(std::size_t pixel, std::size_t image_width) const noexcept {
        return (pixel / image_width - top_ + 1) * columns_ + (pixel % image_width - left_ + 1);
    }

    void transform() {
        RowTransform row_transform;
        std::vector<double> line(rows_);
        for (std::size_t column = 0; column < columns_; ++column) {
            for (std::size_t row = 0; row < rows_; ++row) {
                line[row] = squared_[row * columns_ + column];
            }
            row_transform.run(line);
            for (std::size_t row = 0; row < rows_; ++row) {
                squared_[row * columns_ + column] = line[row];
            }
        }
        for (std::size_t row = 0; row < rows_; ++row) {
            const auto begin = squared_.begin() + static_cast<std::ptrdiff_t>(row * columns_);
            line.assign(begin, begin + static_cast<std::ptrdiff_t>(columns_));
            row_transform.run(line);
            std::copy(line.begin(), line.end(), begin);
        }
    }

    std::size_t left_, top_, columns_ = 0, rows_ = 0;
    std::vector<double> squared_;
};

double weighted(double membership, double weight) noexcept {
    if (weight == 1.0 || membership <= 0.0) {
        return weight == 0.0 ? 1.0 : std::max(membership, 0.0);
    }
    return math::pow(membership, weight);
}

/// Greedy optimisation of the leader lines, section 6.1.
class Greedy {
public:
    Greedy(const IdImage& image,
           std::span<const LabelledObject> objects,
           const LabelOptions& options,
           const Interior& interior,
           const LabelLayout* previous)
        : options_(options), interior_(interior), diagonal_(interior.diagonal()) {
        collect(image, objects);
        rate(previous);
    }

    /// One leader line per object that has candidates.
    std::vector<std::optional<Candidate>> run() {
        std::vector<std::optional<Candidate>> placed(candidates_.size());
        for (;;) {
            const std::size_t next = next_object(placed);
            if (next == candidates_.size()) {
                return placed;
            }
            const Candidates& candidates = candidates_[next];
            placed[next] = *std::max_element(
                candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
                    return a.feasibility < b.feasibility;
                });
            for (std::size_t other = 0; other < candidates_.size(); ++other) {
                if (!placed[other]) {
                    keep_away(candidates_[other], *placed[next]);
                }
            }
        }
    }

private:
    /// The leader lines of an anchor, the shorter one first; a side that labels must not stand at
    /// has none.
    Candidates lines_of(const dvec2& anchor) const {
        const auto line = [&](bool is_left) {
            return Candidate{.anchor = anchor,
                             .end = {interior_.side(is_left).x(anchor.y), anchor.y},
                             .is_left = is_left};
        };
        const Candidate left = line(true), right = line(false);
        if (options_.sides != LabelSides::both) {
            return {options_.sides == LabelSides::left ? left : right};
        }
        return anchor.x - left.end.x <= right.end.x - anchor.x ? Candidates{left, right}
                                                               : Candidates{right, left};
    }

    void collect(const IdImage& image, std::span<const LabelledObject> objects) {
        candidates_.resize(objects.size());
        std::vector<std::vector<std::size_t>> pixels(objects.size());
        for (std::size_t pixel = 0; pixel < image.objects.size(); ++pixel) {
            const std::uint32_t object = image.objects[pixel];
            if (object < objects.size()) {
                pixels[object].push_back(pixel);
            }
        }
        for (std::size_t object = 0; object < objects.size(); ++object) {
            fixed_.push_back(objects[object].anchor);
            if (objects[object].anchor) {
                candidates_[object] = lines_of(*objects[object].anchor);
            } else if (!pixels[object].empty()) {
                const Area area(image, static_cast<std::uint32_t>(object), pixels[object]);
                for (const std::size_t pixel : pixels[object]) {
                    // Section 5.1: the shorter leader line, which follows from the anchor.
                    candidates_[object].push_back(
                        lines_of({static_cast<double>(pixel % image.width) + 0.5,
                                  static_cast<double>(pixel / image.width) + 0.5})
                            .front());
                    candidates_[object].back().salience = area.distance_outside(pixel, image.width);
                }
            }
        }
    }

    /// How far a line stays away from the fixed anchors of other objects.
    double clearance(const Candidate& line, std::size_t object) const noexcept {
        double nearest = std::numeric_limits<double>::infinity();
        const double low = std::min(line.anchor.x, line.end.x);
        const double high = std::max(line.anchor.x, line.end.x);
        for (std::size_t other = 0; other < fixed_.size(); ++other) {
            if (other != object && fixed_[other]) {
                const dvec2& point = *fixed_[other];
                nearest = std::min(
                    nearest, distance(point, {std::clamp(point.x, low, high), line.anchor.y}));
            }
        }
        return nearest;
    }

    /// Equations (2), (3), (8) and (9), aggregated by (12), and the clearance of lines.
    void rate(const LabelLayout* previous) {
        double longest = 0.0;
        for (const Candidates& candidates : candidates_) {
            for (const Candidate& line : candidates) {
                longest = std::max(longest, distance(line.anchor, line.end));
            }
        }
        const LabelWeights& weights = options_.weights;
        for (std::size_t object = 0; object < candidates_.size(); ++object) {
            const Label* before = previous != nullptr && previous->labels[object]
                                      ? &*previous->labels[object]
                                      : nullptr;
            for (Candidate& line : candidates_[object]) {
                if (longest > 0.0) {
                    const double length = distance(line.anchor, line.end) / longest;
                    line.feasibility = weighted(1.0 - length, weights.leader_length) *
                                       weighted(line.salience / longest, weights.anchor_salience);
                }
                const double clear = clearance(line, object) / options_.box_height;
                line.feasibility *= weighted(std::min(clear, 1.0), weights.line_clearance);
                if (before != nullptr) {
                    const double moved = distance(line.anchor, before->anchor) / diagonal_;
                    const double end_moved = distance(line.end, before->end) / diagonal_;
                    line.feasibility *= weighted(1.0 - moved, weights.anchor_coherence) *
                                        weighted(1.0 - end_moved, weights.end_coherence);
                }
            }
        }
    }

    /// Section 5.4: first comes the object that has the least feasible candidates. Equation (14) as
    /// printed, with the greatest sum of 1 - F first, prefers large areas, which the text excludes.
    /// Fixed anchors have the least freedom and precede all others.
    std::size_t next_object(const std::vector<std::optional<Candidate>>& placed) const {
        std::size_t best = candidates_.size();
        std::pair best_rank(true, std::numeric_limits<double>::infinity());  // floats, sum
        for (std::size_t object = 0; object < candidates_.size(); ++object) {
            if (placed[object] || candidates_[object].empty()) {
                continue;
            }
            double sum = 0.0;
            for (const Candidate& line : candidates_[object]) {
                sum += line.feasibility;
            }
            const std::pair rank(!fixed_[object].has_value(), sum);
            if (rank < best_rank) {
                best_rank = rank;
                best = object;
            }
        }
        return best;
    }

    /// Equations (4) to (7): what the line just placed leaves of the feasibility of others.
    void keep_away(Candidates& candidates, const Candidate& placed) const {
        const double wanted = options_.min_anchor_distance * diagonal_;
        for (Candidate& line : candidates) {
            const double anchors = distance(line.anchor, placed.anchor);
            const double ends = distance(line.end, placed.end);
            if (anchors < wanted) {
                line.feasibility *= weighted(anchors / wanted, options_.weights.anchor_distance);
            }
            if (ends < options_.box_height) {
                line.feasibility *=
                    weighted(ends / options_.box_height, options_.weights.end_distance);
            }
        }
    }

    const LabelOptions& options_;
    const Interior& interior_;
    double diagonal_;
    std::vector<Candidates> candidates_;
    std::vector<std::optional<dvec2>> fixed_;  // anchors
};

/// Rows nearest to `wanted`, which ascend, that are `spacing` apart: isotonic regression by pooling
/// adjacent violators (Ayer et al. 1955).
std::vector<double> spread(const std::vector<double>& wanted, double spacing) {
    struct Pool {
        double sum = 0.0;
        std::size_t count = 0;
        double mean() const noexcept { return sum / static_cast<double>(count); }
    };
    std::vector<Pool> pools;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        pools.push_back({wanted[i] - spacing * static_cast<double>(i), 1});
        while (pools.size() > 1 && pools[pools.size() - 2].mean() > pools.back().mean()) {
            const Pool last = pools.back();
            pools.pop_back();
            pools.back().sum += last.sum;
            pools.back().count += last.count;
        }
    }
    std::vector<double> rows;
    for (const Pool& pool : pools) {
        for (std::size_t i = 0; i < pool.count; ++i) {
            // A pool of one stays where it was wanted, to the last bit.
            rows.push_back(pool.count == 1
                               ? wanted[rows.size()]
                               : pool.mean() + spacing * static_cast<double>(rows.size()));
        }
    }
    return rows;
}

/// Section 5.5: corrections where leader lines end too close to each other.
class Correction {
public:
    Correction(Interior interior, double box_height)
        : interior_(std::move(interior)), box_height_(box_height) {}

    void run(LabelLayout& layout) {
        for (std::optional<Label>& label : layout.labels) {
            if (label) {
                labels_.push_back(&*label);
            }
        }
        separate(true);
        separate(false);
        attach();
        uncross();
    }

private:
    /// Moves the exits of a side apart; a leader line whose exit moves is no longer horizontal.
    void separate(bool is_left) {
        std::vector<Label*> stack;
        std::copy_if(
            labels_.begin(), labels_.end(), std::back_inserter(stack), [&](const Label* label) {
                return label->is_left == is_left;
            });
        std::stable_sort(stack.begin(), stack.end(), [](const Label* a, const Label* b) {
            return a->end.y < b->end.y;
        });
        std::vector<double> rows;
        for (const Label* label : stack) {
            rows.push_back(label->end.y);
        }
        rows = spread(rows, box_height_);
        for (std::size_t i = 0; i < stack.size(); ++i) {
            stack[i]->exit.y = rows[i];
        }
        if (!rows.empty()) {
            interior_.include_rows(rows.front(), rows.back());
        }
    }

    /// Ends of the boxes at their rows: outside of the interior area over their whole height.
    void attach() {
        for (Label* label : labels_) {
            const Side& side = interior_.side(label->is_left);
            const double row = label->exit.y;
            label->exit.x = side.x(row);
            label->box = {side.clear_x(row - box_height_ / 2.0, row + box_height_ / 2.0), row};
        }
    }

    static bool cross(const Label& a, const Label& b) noexcept {
        using geometry::orient2d;
        return orient2d(a.anchor, a.exit, b.anchor) * orient2d(a.anchor, a.exit, b.exit) < 0 &&
               orient2d(b.anchor, b.exit, a.anchor) * orient2d(b.anchor, b.exit, a.exit) < 0;
    }

    /// Swaps the boxes of leader lines that cross. Crossings are exact and each swap makes the
    /// lines shorter in sum (triangle inequality), so that this ends.
    void uncross() {
        bool has_swapped = true;
        while (has_swapped) {
            has_swapped = false;
            for (Label* a : labels_) {
                for (Label* b : labels_) {
                    if (cross(*a, *b)) {
                        std::swap(a->exit, b->exit);
                        std::swap(a->box, b->box);
                        std::swap(a->is_left, b->is_left);
                        has_swapped = true;
                    }
                }
            }
        }
    }

    Interior interior_;
    double box_height_;
    std::vector<Label*> labels_;
};

}  // namespace

LabelLayout place_labels(const IdImage& image,
                         std::span<const LabelledObject> objects,
                         const LabelOptions& options,
                         const LabelLayout* previous) {
    EARSHOT_ASSERT(image.objects.size() == image.width * image.height);
    EARSHOT_ASSERT(options.box_height > 0.0 && options.margin >= 0.0);
    EARSHOT_ASSERT(previous == nullptr || previous->labels.size() == objects.size());
    LabelLayout layout{.labels = std::vector<std::optional<Label>>(objects.size())};
    std::vector<dvec2> points = interior_points(image, objects, options.margin);
    if (points.empty()) {
        return layout;
    }
    Interior interior(std::move(points));
    const auto lines = Greedy(image, objects, options, interior, previous).run();
    for (std::size_t object = 0; object < objects.size(); ++object) {
        if (lines[object]) {
            const Candidate& line = *lines[object];
            layout.labels[object] = Label{.anchor = line.anchor,
                                          .end = line.end,
                                          .exit = line.end,
                                          .box = line.end,
                                          .is_left = line.is_left};
        }
    }
    Correction(std::move(interior), options.box_height).run(layout);
    return layout;
}

}  // namespace earshot::visibility
