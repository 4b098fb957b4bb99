// SPDX-License-Identifier: MIT
#include "earshot/cli/check_picture.h"

#include "earshot/geometry/facets.h"
#include "earshot/io/svg.h"
#include "earshot/propagation/plausibility.h"

#include <algorithm>
#include <vector>

namespace earshot::cli {
namespace {

using geometry::Vec3;
using io::SvgPoint;

constexpr double kWidth = 640.0;  // of the drawing, without margins
constexpr double kMargin = 30.0;
constexpr std::size_t kMaxOutlines = 20000;
constexpr double kMinRadius = 4.0;

/// A view along an axis: what is drawn to the right and up.
struct View {
    int right = 0;
    int up = 1;
    bool up_is_negative = false;  // a plan has -Z at its top
    double top = 0.0;             // of its frame in the picture
};

class Drawing {
public:
    Drawing(const propagation::Scene& scene, double time, const propagation::ModelReport& report)
        : scene_(scene),
          time_(time),
          report_(report),
          scale_(kWidth / std::max(1e-9, report.extent.size().x)),
          plan_{.right = 0, .up = 2, .up_is_negative = true, .top = kMargin},
          elevation_{.right = 0, .up = 1, .top = 2.0 * kMargin + scale_ * report.extent.size().z},
          picture_(kWidth + 2.0 * kMargin,
                   3.0 * kMargin + scale_ * (report.extent.size().z + report.extent.size().y),
                   12.0,
                   "findings in " + scene.name) {}

    std::string draw() {
        for (const View& view : {plan_, elevation_}) {
            draw_facets(view);
            draw_findings(view);
            draw_emitters(view);
        }
        return picture_.str();
    }

private:
    SvgPoint at(const View& view, const Vec3& p) const {
        const Vec3& lower = report_.extent.lower;
        const Vec3& upper = report_.extent.upper;
        const double down =
            view.up_is_negative ? p[view.up] - lower[view.up] : upper[view.up] - p[view.up];
        return {kMargin + scale_ * (p[view.right] - lower[view.right]), view.top + scale_ * down};
    }

    void draw_facets(const View& view) {
        const std::vector<Vec3> positions = scene_.mesh.positions_at(time_);
        const geometry::CleanMesh& clean = report_.topology.clean;
        std::vector<geometry::Triangle> kept;
        std::vector<std::uint32_t> materials;
        for (const geometry::TriangleId id : clean.kept) {
            kept.push_back(scene_.mesh.triangles()[id]);
            materials.push_back(scene_.material_of_triangle[id]);
        }
        const geometry::Facets facets =
            geometry::find_facets({positions, kept}, clean.weld, materials);
        std::vector<std::vector<SvgPoint>> outlines;
        for (const geometry::Facet& facet : facets.facets) {
            for (const geometry::Loop& loop : facet.loops) {
                if (outlines.size() == kMaxOutlines) {
                    break;
                }
                std::vector<SvgPoint>& outline = outlines.emplace_back();
                for (std::size_t i = 0; i <= loop.size(); ++i) {
                    outline.push_back(at(view, loop[i % loop.size()]));
                }
            }
        }
        picture_.polylines(outlines, "#bbbbbb", 0.5);
    }

    void draw_findings(const View& view) {
        std::vector<bool> leaks(report_.topology.holes.size(), false);
        for (const propagation::Leak& leak : report_.leaks) {
            if (leak.hole != propagation::Leak::kNoHole) {
                leaks[leak.hole] = true;
            }
        }
        for (std::size_t i = 0; i < leaks.size(); ++i) {
            const geometry::HoleLoop& hole = report_.topology.holes[i];
            if (!leaks[i] && !hole.is_outline) {
                mark(view, hole.centre, hole.upper - hole.lower, "orange", "hole");
            }
        }
        for (const propagation::Leak& leak : report_.leaks) {
            mark(view,
                 leak.place.centre,
                 leak.place.size,
                 "#d62728",
                 "leak of " + propagation::short_text(leak.place.area) + " m2");
        }
    }

    void mark(const View& view,
              const Vec3& centre,
              const Vec3& size,
              const char* colour,
              const std::string& title) {
        Vec3 half(0.0);
        half[view.right] = 0.5 * size[view.right];
        half[view.up] = 0.5 * size[view.up];
        picture_.line(at(view, centre - half), at(view, centre + half), colour, 2.0);
        picture_.disc(at(view, centre), kMinRadius, colour, title);
    }

    void draw_emitters(const View& view) {
        for (const bool is_source : {true, false}) {
            const auto& emitters = is_source ? scene_.sources : scene_.listeners;
            for (std::size_t i = 0; i < emitters.size(); ++i) {
                const bool is_misplaced = std::any_of(
                    report_.misplaced.begin(), report_.misplaced.end(), [&](const auto& m) {
                        return m.is_source == is_source && m.index == i;
                    });
                const char* colour = is_misplaced ? "#d62728" : is_source ? "black" : "#1f77b4";
                const SvgPoint place = at(view, scene_.position_at(emitters[i], time_));
                picture_.disc(place, kMinRadius, colour, is_source ? "source" : "listener");
                picture_.text({place.x + 6.0, place.y + 4.0},
                              emitters[i].name,
                              {.fill = colour, .halo = true});
            }
        }
    }

    const propagation::Scene& scene_;
    double time_;
    const propagation::ModelReport& report_;
    double scale_;
    View plan_, elevation_;
    io::SvgPicture picture_;
};

}  // namespace

std::string check_picture(const propagation::Scene& scene,
                          double time,
                          const propagation::ModelReport& report) {
    return Drawing(scene, time, report).draw();
}

}  // namespace earshot::cli
