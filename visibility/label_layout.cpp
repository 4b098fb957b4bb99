// SPDX-License-Identifier: MIT
#include "earshot/visibility/label_layout.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/predicates.h"
#include "earshot/visibility/internal/label_interior.h"
#include "earshot/visibility/internal/leader_lines.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace earshot::visibility {
namespace {

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
    Correction(LabelInterior interior, double box_height)
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
            const InteriorSide& side = interior_.side(label->is_left);
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

    LabelInterior interior_;
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
    std::vector<glm::dvec2> points = interior_points(image, objects, options.margin);
    if (points.empty()) {
        return layout;
    }
    LabelInterior interior(std::move(points));
    const auto lines = place_leader_lines(image, objects, options, interior, previous);
    for (std::size_t object = 0; object < objects.size(); ++object) {
        if (lines[object]) {
            const LeaderLine& line = *lines[object];
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
