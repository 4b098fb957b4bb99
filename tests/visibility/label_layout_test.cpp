// SPDX-License-Identifier: MIT
#include "earshot/visibility/label_layout.h"

#include "earshot/base/random.h"

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "support/label_checks.h"
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace earshot::visibility {
namespace {

using glm::dvec2;

/// A picture that is drawn by predicates on the middles of pixels; later objects hide earlier ones.
class Canvas {
public:
    Canvas(std::size_t width, std::size_t height)
        : image_{width, height, std::vector<std::uint32_t>(width * height, kBackground)} {}

    void paint(std::uint32_t object, const std::function<bool(double, double)>& covers) {
        for (std::size_t pixel = 0; pixel < image_.objects.size(); ++pixel) {
            if (covers(static_cast<double>(pixel % image_.width) + 0.5,
                       static_cast<double>(pixel / image_.width) + 0.5)) {
                image_.objects[pixel] = object;
            }
        }
    }
    void disc(std::uint32_t object, double x, double y, double radius) {
        paint(object, [=](double px, double py) { return std::hypot(px - x, py - y) <= radius; });
    }
    void box(std::uint32_t object, double left, double top, double right, double bottom) {
        paint(object,
              [=](double x, double y) { return x > left && x < right && y > top && y < bottom; });
    }

    const IdImage& image() const { return image_; }

private:
    IdImage image_;
};

/// Discs and boxes at random places.
Canvas random_canvas(std::uint64_t seed, std::uint32_t objects) {
    Canvas canvas(160, 120);
    const RandomStream random(seed, 0);
    std::uint64_t index = 0;
    const auto next = [&](double low, double high) {
        return low + (high - low) * random.at(index++);
    };
    for (std::uint32_t shape = 0; shape < objects + 3; ++shape) {
        const std::uint32_t object = shape < 3 ? kUnlabelled : shape - 3;
        const double x = next(30.0, 130.0), y = next(25.0, 95.0);
        const double size = next(1.0, shape < 3 ? 25.0 : 14.0);
        if (random.at(index++) < 0.5) {
            canvas.disc(object, x, y, size);
        } else {
            canvas.box(object, x - size, y - size / 2.0, x + size, y + size / 2.0);
        }
    }
    return canvas;
}

/// The membership functions of the paper by brute force, for one object after others.
class Oracle {
public:
    Oracle(const IdImage& image, const LabelOptions& options, std::size_t objects)
        : image_(image), options_(options) {
        for (std::size_t row = 0; row < image.height; ++row) {
            for (std::size_t column = 0; column < image.width; ++column) {
                // Pixels between others of their row are no corners of the hull.
                const bool is_between = column > 0 && column + 1 < image.width &&
                                        object_at(column - 1, row) != kBackground &&
                                        object_at(column + 1, row) != kBackground;
                if (object_at(column, row) != kBackground && !is_between) {
                    for (int corner = 0; corner < 4; ++corner) {
                        const double x = static_cast<double>(column) +
                                         (corner % 2 == 0 ? -options.margin : 1.0 + options.margin);
                        const double y = static_cast<double>(row) +
                                         (corner < 2 ? -options.margin : 1.0 + options.margin);
                        corners_.emplace_back(x, y);
                    }
                }
            }
        }
        for (std::size_t pixel = 0; pixel < image.objects.size(); ++pixel) {
            if (image.objects[pixel] < objects) {
                longest_ = std::max(longest_, length_of(middle(pixel)));
            }
        }
        dvec2 low = corners_.front(), high = low;
        for (const dvec2& corner : corners_) {
            low = glm::min(low, corner);
            high = glm::max(high, corner);
        }
        diagonal_ = glm::distance(low, high);
    }

    dvec2 middle(std::size_t pixel) const {
        return {static_cast<double>(pixel % image_.width) + 0.5,
                static_cast<double>(pixel / image_.width) + 0.5};
    }

    /// x of the boundary in a row: the most extreme point of all segments between corners.
    double side_x(double y, bool is_left) {
        const auto known = sides_.find({y, is_left});
        if (known != sides_.end()) {
            return known->second;
        }
        double best = is_left ? 1e9 : -1e9;
        for (const dvec2& a : corners_) {
            for (const dvec2& b : corners_) {
                if (a.y <= y && y <= b.y && a.y < b.y) {
                    const double x = a.x + (b.x - a.x) * (y - a.y) / (b.y - a.y);
                    best = is_left ? std::min(best, x) : std::max(best, x);
                }
            }
        }
        sides_[{y, is_left}] = best;
        return best;
    }

    dvec2 end_of(const dvec2& anchor) {
        const double left = side_x(anchor.y, true), right = side_x(anchor.y, false);
        return {anchor.x - left <= right - anchor.x ? left : right, anchor.y};
    }
    double length_of(const dvec2& anchor) { return glm::distance(anchor, end_of(anchor)); }

    double salience(std::size_t pixel) {
        const auto known = saliences_.find(pixel);
        return known != saliences_.end() ? known->second
                                         : saliences_[pixel] = distance_outside(pixel);
    }

    double distance_outside(std::size_t pixel) const {
        double nearest = std::numeric_limits<double>::infinity();
        for (int row = -1; row <= static_cast<int>(image_.height); ++row) {
            for (int column = -1; column <= static_cast<int>(image_.width); ++column) {
                const bool is_inside = row >= 0 && column >= 0 &&
                                       row < static_cast<int>(image_.height) &&
                                       column < static_cast<int>(image_.width);
                if (!is_inside ||
                    object_at(static_cast<std::size_t>(column), static_cast<std::size_t>(row)) !=
                        image_.objects[pixel]) {
                    nearest =
                        std::min(nearest, glm::distance(middle(pixel), {column + 0.5, row + 0.5}));
                }
            }
        }
        return nearest;
    }

    /// F of a pixel's leader line after `placed`, with f3 times `scale`.
    double feasibility(std::size_t pixel, const std::vector<dvec2>& placed, double scale = 1.0) {
        const dvec2 anchor = middle(pixel);
        double result =
            std::pow(1.0 - length_of(anchor) / longest_, options_.weights.leader_length) *
            std::pow(scale * salience(pixel) / longest_, options_.weights.anchor_salience);
        for (const dvec2& other : placed) {
            const double anchors =
                glm::distance(anchor, other) / (options_.min_anchor_distance * diagonal_);
            const double ends = glm::distance(end_of(anchor), end_of(other)) / options_.box_height;
            result *= std::min(anchors, 1.0) * std::min(ends, 1.0);
        }
        return result;
    }

    std::uint32_t object_at(std::size_t column, std::size_t row) const {
        return image_.objects[row * image_.width + column];
    }

private:
    const IdImage& image_;
    const LabelOptions& options_;
    std::vector<dvec2> corners_;
    std::map<std::pair<double, bool>, double> sides_;
    std::map<std::size_t, double> saliences_;
    double longest_ = 0.0, diagonal_ = 0.0;
};

LabelLayout place(const Canvas& canvas,
                  std::size_t objects,
                  const LabelOptions& options = {},
                  const LabelLayout* previous = nullptr) {
    return place_labels(canvas.image(), std::vector<LabelledObject>(objects), options, previous);
}

TEST(LabelLayout, AnchorsAreTheMostFeasibleByExhaustiveSearch) {
    const LabelOptions options{.box_height = 9.0, .margin = 4.0};
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        constexpr std::uint32_t kObjects = 4;
        Canvas canvas(64, 48);
        const RandomStream random(seed, 7);
        canvas.box(kUnlabelled, 8.0, 6.0, 50.0, 40.0);
        for (std::uint32_t object = 0; object < kObjects; ++object) {
            canvas.disc(object,
                        12.0 + 36.0 * random.at(3 * object),
                        10.0 + 26.0 * random.at(3 * object + 1),
                        2.0 + 6.0 * random.at(3 * object + 2));
        }
        const LabelLayout layout = place(canvas, kObjects, options);
        Oracle oracle(canvas.image(), options, kObjects);
        std::vector<std::vector<std::size_t>> areas(kObjects);
        for (std::size_t pixel = 0; pixel < canvas.image().objects.size(); ++pixel) {
            if (canvas.image().objects[pixel] < kObjects) {
                areas[canvas.image().objects[pixel]].push_back(pixel);
            }
        }
        std::vector<dvec2> placed;
        std::vector<bool> is_placed(kObjects);
        for (std::uint32_t step = 0; step < kObjects; ++step) {
            double least = std::numeric_limits<double>::infinity();
            std::uint32_t next = kObjects;
            double best = 0.0;
            for (std::uint32_t object = 0; object < kObjects; ++object) {
                double sum = 0.0, highest = 0.0;
                for (const std::size_t pixel : areas[object]) {
                    const double feasibility = oracle.feasibility(pixel, placed);
                    sum += feasibility;
                    highest = std::max(highest, feasibility);
                }
                if (!is_placed[object] && !areas[object].empty() && sum < least) {
                    least = sum;
                    next = object;
                    best = highest;
                }
            }
            if (next == kObjects) {
                break;  // the others are hidden
            }
            is_placed[next] = true;
            ASSERT_TRUE(layout.labels[next]) << seed;
            const dvec2 anchor = layout.labels[next]->anchor;
            const auto pixel = static_cast<std::size_t>(anchor.y) * canvas.image().width +
                               static_cast<std::size_t>(anchor.x);
            ASSERT_EQ(canvas.image().objects[pixel], next) << seed;
            EXPECT_NEAR(oracle.feasibility(pixel, placed), best, 1e-12 * best) << seed;
            // Whatever the scale of a membership function, the choice is the same.
            for (const std::size_t other : areas[next]) {
                EXPECT_LE(oracle.feasibility(other, placed, 0.5),
                          oracle.feasibility(pixel, placed, 0.5) * (1.0 + 1e-12))
                    << seed;
            }
            EXPECT_NEAR(layout.labels[next]->end.x, oracle.end_of(anchor).x, 1e-9) << seed;
            placed.push_back(anchor);
        }
    }
}

// A label's height of 12 needs more rows than the drawing has where there are many.
TEST(LabelLayout, NeitherLinesCrossNorBoxesOverlapInRandomPictures) {
    std::size_t moved = 0, labels = 0;
    for (std::uint64_t seed = 1; seed <= 200; ++seed) {
        const auto objects = static_cast<std::uint32_t>(2 + seed % 14);
        const Canvas canvas = random_canvas(seed, objects);
        std::vector<LabelledObject> labelled(objects);
        for (std::uint32_t object = 0; object < objects; object += 3) {
            // Several at one row, as of listeners in a row of seats.
            labelled[object].anchor =
                dvec2(40.0 + 5.0 * object, 60.0 + static_cast<double>(object % 2));
        }
        const LabelOptions options{.box_height = 12.0, .margin = 3.0};
        const LabelLayout layout = place_labels(canvas.image(), labelled, options);
        EXPECT_TRUE(test::labels_are_apart(layout, options.box_height)) << seed;
        EXPECT_TRUE(test::boxes_clear_drawing(layout, canvas.image(), options)) << seed;
        for (std::uint32_t object = 0; object < objects; ++object) {
            const std::vector<std::uint32_t>& pixels = canvas.image().objects;
            const bool is_visible = labelled[object].anchor.has_value() ||
                                    std::count(pixels.begin(), pixels.end(), object) > 0;
            EXPECT_EQ(layout.labels[object].has_value(), is_visible) << seed;
            if (layout.labels[object]) {
                ++labels;
                moved += layout.labels[object]->exit != layout.labels[object]->end ? 1 : 0;
            }
        }
    }
    EXPECT_GT(labels, 1400U);
    EXPECT_GT(moved, 200U);
    RecordProperty("labels", std::to_string(labels));
    RecordProperty("moved", std::to_string(moved));
}

TEST(LabelLayout, LinesAreHorizontalWhereThereIsRoom) {
    Canvas canvas(200, 200);
    canvas.box(kUnlabelled, 40.0, 40.0, 160.0, 160.0);
    for (std::uint32_t object = 0; object < 4; ++object) {
        canvas.disc(object, object % 2 == 0 ? 60.5 : 140.5, 60.5 + 25.0 * object, 6.0);
    }
    const LabelLayout layout = place(canvas, 4);
    for (std::size_t object = 0; object < 4; ++object) {
        ASSERT_TRUE(layout.labels[object]);
        EXPECT_EQ(layout.labels[object]->anchor.y, layout.labels[object]->box.y);
        EXPECT_EQ(layout.labels[object]->is_left, object % 2 == 0);
        EXPECT_EQ(layout.labels[object]->box.x, object % 2 == 0 ? 32.0 : 168.0);
    }
}

TEST(LabelLayout, SidesCanBeChosen) {
    Canvas canvas(100, 100);
    canvas.disc(0, 20.0, 50.0, 8.0);
    canvas.disc(1, 80.0, 50.0, 8.0);
    const LabelLayout left = place(canvas, 2, {.sides = LabelSides::left});
    const LabelLayout right = place(canvas, 2, {.sides = LabelSides::right});
    for (std::size_t object = 0; object < 2; ++object) {
        EXPECT_TRUE(left.labels[object]->is_left);
        EXPECT_FALSE(right.labels[object]->is_left);
    }
}

TEST(LabelLayout, HiddenObjectsHaveNoLabel) {
    Canvas canvas(50, 50);
    canvas.box(0, 10.0, 10.0, 20.0, 20.0);
    canvas.box(1, 5.0, 5.0, 30.0, 30.0);
    const LabelLayout layout = place(canvas, 3);
    EXPECT_FALSE(layout.labels[0]);
    EXPECT_TRUE(layout.labels[1]);
    EXPECT_FALSE(layout.labels[2]);
    EXPECT_TRUE(place_labels({}, {}).labels.empty());
}

TEST(LabelLayout, FixedAnchorsStayAndTheirBoxesMoveApart) {
    Canvas canvas(100, 100);
    canvas.box(kUnlabelled, 10.0, 10.0, 90.0, 90.0);
    const std::vector<LabelledObject> objects = {{.anchor = dvec2(30.0, 50.0)},
                                                 {.anchor = dvec2(30.0, 50.0)},
                                                 {.anchor = dvec2(20.0, 52.0)}};
    const LabelOptions options{.box_height = 10.0};
    const LabelLayout layout = place_labels(canvas.image(), objects, options);
    for (std::size_t object = 0; object < 3; ++object) {
        EXPECT_EQ(layout.labels[object]->anchor, *objects[object].anchor);
    }
    EXPECT_TRUE(test::labels_are_apart(layout, options.box_height));
    // Nearest to the rows 50, 50 and 52 in least squares.
    EXPECT_NEAR(
        layout.labels[0]->box.y + layout.labels[1]->box.y + layout.labels[2]->box.y, 152.0, 1e-9);
}

TEST(LabelLayout, StacksMayBeHigherThanTheDrawing) {
    Canvas canvas(60, 40);
    canvas.box(kUnlabelled, 20.0, 15.0, 40.0, 25.0);
    std::vector<LabelledObject> objects;
    for (int i = 0; i < 12; ++i) {
        objects.push_back({.anchor = dvec2(22.0 + i, 20.0)});
    }
    const LabelOptions options{.box_height = 10.0, .margin = 2.0};
    const LabelLayout layout = place_labels(canvas.image(), objects, options);
    EXPECT_TRUE(test::labels_are_apart(layout, options.box_height));
    EXPECT_TRUE(test::boxes_clear_drawing(layout, canvas.image(), options));
}

TEST(LabelLayout, TiesGoToTheFirstPixelAndObject) {
    Canvas canvas(80, 60);
    canvas.box(0, 20.0, 10.0, 30.0, 20.0);
    canvas.box(1, 50.0, 10.0, 60.0, 20.0);
    const LabelLayout layout =
        place(canvas, 2, {.box_height = 4.0, .weights = {.leader_length = 0}});
    // The middle of a square of 10 pixels is a corner of four; the first of them is the anchor.
    EXPECT_EQ(layout.labels[0]->anchor, dvec2(24.5, 14.5));
    EXPECT_EQ(layout.labels[1]->anchor, dvec2(54.5, 14.5));
    EXPECT_TRUE(layout.labels[0]->is_left);
    EXPECT_FALSE(layout.labels[1]->is_left);
    const LabelLayout again =
        place(canvas, 2, {.box_height = 4.0, .weights = {.leader_length = 0}});
    EXPECT_EQ(again.labels[0]->box, layout.labels[0]->box);
}

// With equation (14) as printed the large areas come first, and one of them takes the row of the
// small one.
TEST(LabelLayout, SmallAreasBetweenLargeOnesComeFirst) {
    const LabelOptions options{
        .sides = LabelSides::left, .box_height = 20.0, .weights = {.leader_length = 0.0}};
    Canvas canvas(120, 80);
    canvas.box(0, 10.0, 20.0, 50.0, 59.0);
    canvas.box(2, 70.0, 20.0, 110.0, 59.0);
    canvas.box(1, 55.0, 36.0, 64.0, 43.0);
    Canvas alone(120, 80);
    alone.box(0, 55.0, 36.0, 64.0, 43.0);
    const LabelLayout layout = place(canvas, 3, options);
    EXPECT_EQ(layout.labels[1]->anchor, place(alone, 1, options).labels[0]->anchor);
    EXPECT_EQ(layout.labels[1]->anchor.y, 39.5);
    EXPECT_NE(layout.labels[0]->anchor.y, 39.5);
}

/// The sums of the steps of an anchor and of the middle of the object's area, over frames.
struct Paths {
    double anchor = 0.0, object = 0.0;
};

TEST(LabelLayout, AnchorsMoveAtMostTwiceAsFarAsTheirObjects) {
    constexpr int kFrames = 60;
    constexpr std::size_t kObjects = 4;
    std::vector<Paths> paths(kObjects);
    LabelLayout before;
    std::vector<dvec2> middles(kObjects);
    for (int frame = 0; frame < kFrames; ++frame) {
        Canvas canvas(160, 120);
        canvas.box(kUnlabelled, 20.0, 20.0, 140.0, 100.0);
        canvas.box(0, 30.0, 30.0, 60.0, 50.0);
        canvas.disc(1, 100.0, 40.0, 12.0);
        canvas.disc(2, 70.0, 80.0, 9.0);
        canvas.disc(3, 40.0 + frame, 65.0, 10.0);  // hides part of the object before for a while
        const LabelLayout layout =
            place(canvas, kObjects, {.box_height = 12.0}, frame > 0 ? &before : nullptr);
        for (std::uint32_t object = 0; object < kObjects; ++object) {
            const dvec2 middle = test::middle_of(canvas.image(), object);
            if (frame > 0) {
                paths[object].anchor +=
                    glm::distance(layout.labels[object]->anchor, before.labels[object]->anchor);
                paths[object].object += glm::distance(middle, middles[object]);
            }
            middles[object] = middle;
        }
        EXPECT_TRUE(test::labels_are_apart(layout, 12.0)) << frame;
        before = layout;
    }
    EXPECT_NEAR(paths[3].object, kFrames - 1.0, 1e-9);
    EXPECT_EQ(paths[0].anchor, 0.0);
    EXPECT_EQ(paths[1].anchor, 0.0);
    EXPECT_LE(paths[3].anchor, 2.0 * paths[3].object);
    // What an object that passes before it leaves of an area changes at most as much as that moves.
    EXPECT_GT(paths[2].object, 0.0);
    EXPECT_LE(paths[2].anchor, 2.0 * paths[3].object);
    for (std::size_t object = 0; object < kObjects; ++object) {
        RecordProperty("anchor_path_" + std::to_string(object),
                       std::to_string(paths[object].anchor));
    }
}

TEST(LabelLayout, StandsStillWhereThePictureDoes) {
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const Canvas canvas = random_canvas(seed, 8);
        const LabelLayout first = place(canvas, 8, {.box_height = 12.0});
        const LabelLayout second = place(canvas, 8, {.box_height = 12.0}, &first);
        const LabelLayout third = place(canvas, 8, {.box_height = 12.0}, &second);
        for (std::size_t object = 0; object < 8; ++object) {
            ASSERT_EQ(second.labels[object].has_value(), third.labels[object].has_value());
            if (second.labels[object]) {
                EXPECT_EQ(second.labels[object]->anchor, third.labels[object]->anchor) << seed;
                EXPECT_EQ(second.labels[object]->box, third.labels[object]->box) << seed;
            }
        }
    }
}

}  // namespace
}  // namespace earshot::visibility
