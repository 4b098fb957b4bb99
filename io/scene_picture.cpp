// SPDX-License-Identifier: MIT
#include "earshot/io/scene_picture.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/feature_edges.h"
#include "earshot/io/escape.h"
#include "earshot/io/internal/first_reflectors.h"
#include "earshot/io/internal/picture_projection.h"
#include "earshot/io/internal/scene_lines.h"

#include <glm/geometric.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <utility>

namespace earshot::io {

using geometry::TriangleId;
using geometry::Vec3;
using glm::dvec2;
using propagation::PairResult;

namespace {

constexpr double kFontSize = 13.0;
constexpr double kBoxHeight = 18.0;   // of a label, units
constexpr double kDrawingGap = 14.0;  // from the drawing to the interior area's boundary
constexpr double kTextGap = 4.0;      // from a leader line to its text
constexpr double kBaseline = 4.5;     // of a text below the middle of its box
constexpr double kPaperMargin = 8.0;  // around everything
constexpr double kCutMargin = 0.05;   // of a plan above the highest point that is marked, metres
constexpr std::size_t kMaxLabelLength = 36;  // characters
// Sources and listeners beyond this number have no label: stacks of labels would be many times as
// high as the drawing.
constexpr std::size_t kMaxLabelledMarks = 60;
constexpr const char* kSourceColour = "#c1121f";
constexpr const char* kListenerColour = "#1d4ed8";
constexpr const char* kReflectorColour = "#15803d";
constexpr const char* kLineColour = "#777";

/// The text without control characters, cut where it is too long for a picture.
std::string label_text(const std::string& name) {
    const std::string text = escape_controls(name);
    std::size_t characters = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool starts = (static_cast<unsigned char>(text[i]) & 0xc0U) != 0x80U;
        if (starts && ++characters > kMaxLabelLength) {
            return text.substr(0, i) + "\u2026";
        }
    }
    return text;
}

/// What a label says and how its object is marked.
struct LabelText {
    std::string text;
    const char* colour = kReflectorColour;
    enum class Mark { disc, ring, dot } mark = Mark::dot;
};

}  // namespace

class ScenePictures::Impl {
public:
    Impl(const propagation::Scene& scene,
         std::vector<double> times,
         std::span<const PairResult> pairs,
         ScenePictureOptions options,
         Executor& executor)
        : scene_(scene),
          times_(std::move(times)),
          options_(std::move(options)),
          projection_(options_.projection) {
        EARSHOT_ASSERT(!times_.empty());
        EARSHOT_ASSERT(options_.colours.empty() ||
                       options_.colours.size() == scene.materials.size());
        include_instants();
        const std::vector<Vec3> positions = scene.mesh.positions_at(times_.front());
        patches_ = geometry::find_feature_edges({positions, scene.mesh.triangles()},
                                                scene.material_of_triangle,
                                                geometry::kCreaseCosine,
                                                executor)
                       .patch_of_triangle;
        reflectors_ = first_reflectors(
            pairs, times_, patches_, options_.max_reflectors, [this](std::uint32_t material) {
                return is_left_out(material);
            });
        reserve_label_width();
    }

    ScenePicture draw(std::size_t frame, Executor& executor) {
        EARSHOT_ASSERT(frame < times_.size());
        // 1. The scene at this instant.
        positions_ = scene_.mesh.positions_at(times_[frame]);
        const geometry::MeshView mesh{positions_, scene_.mesh.triangles()};
        if (bvh_) {
            bvh_->update(mesh, executor);
        } else {
            bvh_.emplace(mesh, bvh::UpdateOptions{}, executor);
        }
        const visibility::ExclusionMask absent = absent_triangles(mesh);
        // 2. Lines, and which reflector each pixel shows.
        const std::vector<PictureLine> edges =
            visible_edges(bvh_->view(), scene_.material_of_triangle, absent, projection_, executor);
        std::vector<PictureLine> section;
        if (projection_.is_plan()) {
            section = section_lines(mesh, absent, projection_);
        }
        ScenePicture picture;
        picture.image = id_image(absent, section, frame, executor);
        // 3. Labels.
        const std::vector<LabelText> texts = label_objects(frame, picture);
        picture.label_options = {.box_height = kBoxHeight / kUnitsPerPixel,
                                 .margin = kDrawingGap / kUnitsPerPixel};
        picture.layout = visibility::place_labels(picture.image,
                                                  picture.objects,
                                                  picture.label_options,
                                                  previous_ ? &*previous_ : nullptr);
        previous_ = picture.layout;
        picture.svg = paint(edges, section, marks_at(times_[frame]), texts, picture.layout);
        return picture;
    }

private:
    static constexpr double kUnitsPerPixel = PictureProjection::kUnitsPerPixel;

    /// Makes room for the scene at all instants, and cuts a plan above all that is marked.
    void include_instants() {
        double highest = std::numeric_limits<double>::lowest();
        double low = std::numeric_limits<double>::max(), high = highest;
        for (const double time : times_) {
            const std::vector<Vec3> positions = scene_.mesh.positions_at(time);
            for (std::size_t id = 0; id < scene_.mesh.triangles().size(); ++id) {
                if (!is_left_out(scene_.material_of_triangle[id])) {
                    const geometry::Corners corners =
                        geometry::corners(positions, scene_.mesh.triangles()[id]);
                    projection_.include(corners);
                    low = std::min({low, corners[0].y, corners[1].y, corners[2].y});
                    high = std::max({high, corners[0].y, corners[1].y, corners[2].y});
                }
            }
            const std::vector<Vec3> marks = marks_at(time);
            projection_.include(marks);
            for (const Vec3& mark : marks) {
                highest = std::max(highest, mark.y);
            }
        }
        const bool has_marks = !scene_.sources.empty() || !scene_.listeners.empty();
        projection_.set_cut(has_marks ? highest + kCutMargin : (low + high) / 2.0);
    }

    std::vector<Vec3> marks_at(double time) const {
        std::vector<Vec3> marks;
        for (const auto* emitters : {&scene_.sources, &scene_.listeners}) {
            for (const propagation::Emitter& emitter : *emitters) {
                marks.push_back(scene_.position_at(emitter, time));
            }
        }
        return marks;
    }

    std::string reflector_text(const FirstReflector& reflector, std::size_t frame) const {
        if (!reflector.reflections[frame]) {
            return {};
        }
        std::array<char, 32> delay{};
        std::snprintf(
            delay.data(), delay.size(), " +%.1f ms", 1000.0 * reflector.reflections[frame]->delay);
        return label_text(scene_.materials[reflector.material].name) + delay.data();
    }

    void reserve_label_width() {
        const auto include = [&](const std::string& text) {
            label_width_ = std::max(label_width_, svg_text_width(text, kFontSize));
        };
        for (const auto* emitters : {&scene_.sources, &scene_.listeners}) {
            for (const propagation::Emitter& emitter : *emitters) {
                include(label_text(emitter.name));
            }
        }
        for (const FirstReflector& reflector : reflectors_) {
            for (std::size_t frame = 0; frame < times_.size(); ++frame) {
                include(reflector_text(reflector, frame));
            }
        }
    }

    bool is_left_out(std::uint32_t material) const {
        return !options_.colours.empty() && options_.colours[material].empty();
    }

    visibility::ExclusionMask absent_triangles(const geometry::MeshView& mesh) const {
        visibility::ExclusionMask absent;
        for (std::size_t id = 0; id < mesh.triangles.size(); ++id) {
            const auto [a, b, c] = geometry::corners(mesh, id);
            const bool is_back_face =
                !projection_.is_plan() &&
                glm::dot(glm::cross(b - a, c - a), projection_.towards()) <= 0.0;
            if (is_back_face || is_left_out(scene_.material_of_triangle[id])) {
                absent.add(static_cast<TriangleId>(id));
            }
        }
        return absent;
    }

    /// The object number of each triangle's reflector, if it reflects at this instant.
    std::vector<std::uint32_t> object_of_patch(std::size_t frame) const {
        const std::size_t marks = scene_.sources.size() + scene_.listeners.size();
        std::vector<std::uint32_t> objects(patches_.size(), visibility::kUnlabelled);
        for (std::size_t i = 0; i < reflectors_.size(); ++i) {
            if (reflectors_[i].reflections[frame]) {
                objects[reflectors_[i].patch] = static_cast<std::uint32_t>(marks + i);
            }
        }
        return objects;
    }

    visibility::IdImage id_image(const visibility::ExclusionMask& absent,
                                 const std::vector<PictureLine>& section,
                                 std::size_t frame,
                                 Executor& executor) const {
        const std::vector<std::uint32_t> objects = object_of_patch(frame);
        const visibility::ItemBuffer buffer = visibility::render_item_buffer(
            bvh_->view(), projection_.viewpoint(), projection_.view(), absent, executor);
        visibility::IdImage image{.width = buffer.view.width,
                                  .height = buffer.view.height,
                                  .objects = std::vector<std::uint32_t>(buffer.triangles.size(),
                                                                        visibility::kBackground)};
        for (std::size_t pixel = 0; pixel < image.objects.size(); ++pixel) {
            const TriangleId triangle = buffer.triangles[pixel];
            if (triangle != visibility::kNoTriangle) {
                image.objects[pixel] = objects[patches_[triangle]];
            }
        }
        // Walls have no area in a plan but where they are cut: the pixels on their lines.
        for (const PictureLine& line : section) {
            rasterise(line, objects[patches_[line.triangle]], image);
        }
        return image;
    }

    static void rasterise(const PictureLine& line,
                          std::uint32_t object,
                          visibility::IdImage& image) {
        const dvec2 from = line.from / kUnitsPerPixel, to = line.to / kUnitsPerPixel;
        const auto steps = static_cast<std::size_t>(2.0 * glm::distance(from, to)) + 1;
        const auto clamped = [](double at, std::size_t size) {
            return static_cast<std::size_t>(
                std::clamp(std::floor(at), 0.0, static_cast<double>(size) - 1.0));
        };
        for (std::size_t step = 0; step <= steps; ++step) {
            const dvec2 at =
                from + (to - from) * (static_cast<double>(step) / static_cast<double>(steps));
            image.objects[clamped(at.y, image.height) * image.width + clamped(at.x, image.width)] =
                object;
        }
    }

    /// Sources and listeners have fixed anchors; so has a reflector that no pixel shows, at its
    /// point of reflection. The anchors of the others float.
    std::vector<LabelText> label_objects(std::size_t frame, ScenePicture& picture) const {
        std::vector<LabelText> texts;
        const auto fixed = [&](const Vec3& point) {
            return visibility::LabelledObject{projection_.project(point) / kUnitsPerPixel};
        };
        for (const Vec3& mark : marks_at(times_[frame])) {
            const std::size_t i = texts.size();
            const bool is_source = i < scene_.sources.size();
            const propagation::Emitter& emitter =
                is_source ? scene_.sources[i] : scene_.listeners[i - scene_.sources.size()];
            picture.objects.push_back(i < kMaxLabelledMarks ? fixed(mark)
                                                            : visibility::LabelledObject{});
            texts.push_back({.text = label_text(emitter.name),
                             .colour = is_source ? kSourceColour : kListenerColour,
                             .mark = LabelText::Mark::disc});
        }
        for (const FirstReflector& reflector : reflectors_) {
            const std::optional<FirstReflection>& reflection = reflector.reflections[frame];
            const auto object = static_cast<std::uint32_t>(texts.size());
            const auto& pixels = picture.image.objects;
            const bool is_shown = std::find(pixels.begin(), pixels.end(), object) != pixels.end();
            picture.objects.push_back(reflection && !is_shown ? fixed(reflection->point)
                                                              : visibility::LabelledObject{});
            texts.push_back({.text = reflector_text(reflector, frame),
                             .colour = kReflectorColour,
                             .mark = is_shown ? LabelText::Mark::dot : LabelText::Mark::ring});
        }
        return texts;
    }

    std::string colour_of(std::uint32_t material) const {
        return options_.colours.empty() ? kLineColour : options_.colours[material];
    }

    void paint_lines(const std::vector<PictureLine>& lines,
                     const dvec2& offset,
                     double width,
                     SvgPicture& svg) const {
        std::map<std::string, std::vector<std::vector<SvgPoint>>> by_colour;
        for (const PictureLine& line : lines) {
            const auto point = [&](const dvec2& at) {
                return SvgPoint{std::round(at.x + offset.x), std::round(at.y + offset.y)};
            };
            const SvgPoint from = point(line.from), to = point(line.to);
            if (from.x != to.x || from.y != to.y) {
                by_colour[colour_of(scene_.material_of_triangle[line.triangle])].push_back(
                    {from, to});
            }
        }
        for (const auto& [colour, polylines] : by_colour) {
            svg.polylines(polylines, colour, width);
        }
    }

    /// Corners of what holds the drawing and its labels; the same width in all of a sequence.
    std::pair<dvec2, dvec2> paper(const std::vector<LabelText>& texts,
                                  const visibility::LabelLayout& layout) const {
        dvec2 low(-kDrawingGap), high(projection_.width(), projection_.height());
        high += kDrawingGap;
        if (times_.size() > 1) {
            low.x -= kTextGap + label_width_;
            high.x += kTextGap + label_width_;
        }
        for (std::size_t i = 0; i < texts.size(); ++i) {
            if (layout.labels[i]) {
                const dvec2 box = layout.labels[i]->box * kUnitsPerPixel;
                const double width = kTextGap + svg_text_width(texts[i].text, kFontSize);
                const bool is_left = layout.labels[i]->is_left;
                low = glm::min(low, {is_left ? box.x - width : box.x, box.y - kBoxHeight / 2.0});
                high = glm::max(high, {is_left ? box.x : box.x + width, box.y + kBoxHeight / 2.0});
            }
        }
        return {low, high};
    }

    std::string paint(const std::vector<PictureLine>& edges,
                      const std::vector<PictureLine>& section,
                      const std::vector<Vec3>& marks,
                      const std::vector<LabelText>& texts,
                      const visibility::LabelLayout& layout) const {
        const auto [low, high] = paper(texts, layout);
        const dvec2 offset = glm::ceil(kPaperMargin - low);
        SvgPicture svg(std::ceil(high.x + offset.x + kPaperMargin),
                       std::ceil(high.y + offset.y + kPaperMargin),
                       kFontSize,
                       escape_controls(scene_.name));
        paint_lines(edges, offset, 1.0, svg);
        paint_lines(section, offset, 2.0, svg);
        for (std::size_t i = kMaxLabelledMarks; i < marks.size(); ++i) {
            const dvec2 at = projection_.project(marks[i]) + offset;
            paint_mark(texts[i], {at.x, at.y}, svg);
        }
        paint_labels(texts, layout, offset, svg);
        return svg.str();
    }

    static void paint_labels(const std::vector<LabelText>& texts,
                             const visibility::LabelLayout& layout,
                             const dvec2& offset,
                             SvgPicture& svg) {
        const auto point = [&](const dvec2& at) {
            return SvgPoint{at.x * kUnitsPerPixel + offset.x, at.y * kUnitsPerPixel + offset.y};
        };
        // All leader lines come before all marks, so that no line runs over one.
        for (const bool is_halo : {true, false}) {
            for (std::size_t i = 0; i < texts.size(); ++i) {
                if (layout.labels[i]) {
                    const visibility::Label& label = *layout.labels[i];
                    svg.polyline(
                        std::array{point(label.anchor), point(label.exit), point(label.box)},
                        is_halo ? "#fff" : texts[i].colour,
                        is_halo ? 3.0 : 0.8);
                }
            }
        }
        for (std::size_t i = 0; i < texts.size(); ++i) {
            if (layout.labels[i]) {
                const visibility::Label& label = *layout.labels[i];
                paint_mark(texts[i], point(label.anchor), svg);
                const SvgPoint box = point(label.box);
                svg.text({box.x + (label.is_left ? -kTextGap : kTextGap), box.y + kBaseline},
                         texts[i].text,
                         {.fill = texts[i].colour, .anchor = label.is_left ? "end" : "start"});
            }
        }
    }

    static void paint_mark(const LabelText& label, const SvgPoint& at, SvgPicture& svg) {
        switch (label.mark) {
            case LabelText::Mark::disc:
                svg.disc(at, 6.5, "#fff");
                svg.disc(at, 5.0, label.colour, label.text);
                break;
            case LabelText::Mark::ring:
                svg.disc(at, 4.5, label.colour, label.text);
                svg.disc(at, 3.0, "#fff");
                break;
            case LabelText::Mark::dot:
                svg.disc(at, 2.5, label.colour, label.text);
                break;
        }
    }

    const propagation::Scene& scene_;
    std::vector<double> times_;
    ScenePictureOptions options_;
    PictureProjection projection_;
    std::vector<std::uint32_t> patches_;  // per triangle
    std::vector<FirstReflector> reflectors_;
    double label_width_ = 0.0;  // of the widest, units
    std::vector<Vec3> positions_;
    std::optional<bvh::DeformableBvh> bvh_;
    std::optional<visibility::LabelLayout> previous_;
};

ScenePictures::ScenePictures(const propagation::Scene& scene,
                             std::vector<double> times,
                             std::span<const PairResult> pairs,
                             ScenePictureOptions options,
                             Executor& executor)
    : impl_(std::make_unique<Impl>(scene, std::move(times), pairs, std::move(options), executor)) {}

ScenePictures::~ScenePictures() = default;
ScenePictures::ScenePictures(ScenePictures&&) noexcept = default;
ScenePictures& ScenePictures::operator=(ScenePictures&&) noexcept = default;

ScenePicture ScenePictures::draw(std::size_t frame, Executor& executor) {
    return impl_->draw(frame, executor);
}

}  // namespace earshot::io
