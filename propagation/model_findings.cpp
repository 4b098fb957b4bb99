// SPDX-License-Identifier: MIT
#include "earshot/propagation/model_findings.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace earshot::propagation {
namespace {

using geometry::Vec3;

/// Findings of a kind that are told one by one; the rest is counted.
constexpr std::size_t kMaxOfKind = 3;
/// A model whose faces are reversed to this share of the area is inside out.
constexpr double kInsideOutShare = 0.5;
/// Facets of less than this share of the area hardly matter.
constexpr double kMinSmallShare = 0.02;

std::string place_text(const Vec3& at) {
    return short_text(at.x) + ", " + short_text(at.y) + ", " + short_text(at.z);
}

std::string counted(std::size_t count, const std::string& one, const std::string& many) {
    return std::to_string(count) + " " + (count == 1 ? one : many);
}

std::string percent(double share) {
    const double value = 100.0 * share;
    return (value > 0.0 && value < 1.0 ? "under 1" : short_text(std::round(value))) + " %";
}

/// The two largest sides of a box: those of a slit or a panel.
std::string sides_text(const Vec3& size) {
    double sides[3] = {size.x, size.y, size.z};
    std::sort(sides, sides + 3);
    return short_text(sides[2]) + " x " + short_text(sides[1]) + " m";
}

class Writer {
public:
    Writer(const Scene& scene, const ModelReport& report, bool has_unit_option)
        : scene_(scene), report_(report), has_unit_option_(has_unit_option) {}

    std::vector<Finding> write() {
        add_misplaced();
        add_unit();
        add_leaks();
        add_reversed();
        add_doubled();
        add_materials();
        add_notes();
        std::stable_sort(
            findings_.begin(), findings_.end(), [](const Finding& a, const Finding& b) {
                return a.severity > b.severity;
            });
        return std::move(findings_);
    }

private:
    void add(Severity severity, std::string text) {
        findings_.push_back({severity, std::move(text)});
    }

    void add_misplaced() {
        // Sources of which none can be heard, or listeners of which none hears, leave nothing.
        std::size_t sources = 0;
        for (const MisplacedEmitter& misplaced : report_.misplaced) {
            sources += misplaced.is_source ? 1 : 0;
        }
        const std::size_t listeners = report_.misplaced.size() - sources;
        const bool is_useless = (sources > 0 && sources == scene_.sources.size()) ||
                                (listeners > 0 && listeners == scene_.listeners.size());
        const Severity severity = is_useless ? Severity::unusable : Severity::questionable;
        std::size_t told = 0;
        for (const MisplacedEmitter& misplaced : report_.misplaced) {
            if (told++ < kMaxOfKind) {
                add(severity, misplaced_text(misplaced));
            }
        }
        if (told > kMaxOfKind) {
            add(severity,
                counted(told - kMaxOfKind, "more source or listener", "more sources or listeners") +
                    " misplaced");
        }
    }

    std::string misplaced_text(const MisplacedEmitter& misplaced) const {
        const Emitter& emitter = misplaced.is_source ? scene_.sources[misplaced.index]
                                                     : scene_.listeners[misplaced.index];
        const std::string who = (misplaced.is_source ? "source \"" : "listener \"") + emitter.name +
                                "\" at " + place_text(misplaced.position);
        const std::string rays = ", by " + std::to_string(report_.rays) + " rays";
        switch (misplaced.fault) {
            case EmitterFault::in_solid:
                return who + " is inside a solid" +
                       (misplaced.is_proven ? "" : ": it sees nothing but backs") +
                       "; move it into the air";
            case EmitterFault::outside:
                return who + " is outside of the " + (misplaced.is_proven ? "room" : "model") +
                       "; move it into the air of the others";
            case EmitterFault::sealed:
                break;
        }
        return who +
               " is in a sealed room: " + (misplaced.is_source ? "no listener" : "no source") +
               " shares its air" + (misplaced.is_proven ? "" : rays);
    }

    void add_unit() {
        if (report_.unit) {
            add(Severity::questionable,
                unit_warning(*report_.unit, report_.extent.size(), has_unit_option_));
        }
    }

    void add_leaks() {
        double area = 0.0;
        for (std::size_t i = 0; i < report_.leaks.size(); ++i) {
            const auto& [place, escapes, hole] = report_.leaks[i];
            area += place.area;
            if (i < kMaxOfKind) {
                add(Severity::questionable,
                    "sound leaks at " + place_text(place.centre) + " through " +
                        (hole == Leak::kNoHole ? "a gap of " : "a hole of ") +
                        sides_text(place.size) + " (" + short_text(place.area) + " m2) " +
                        (escapes ? "out of the model" : "into a solid or another room"));
            }
        }
        if (report_.leaks.size() > kMaxOfKind) {
            add(Severity::questionable,
                counted(report_.leaks.size() - kMaxOfKind, "more leak", "more leaks") + ", " +
                    short_text(area) + " m2 in all");
        }
    }

    void add_reversed() {
        double area = 0.0;
        for (const FaceGroup& group : report_.reversed) {
            area += group.place.area;
        }
        double surface = 0.0;
        for (const MaterialUse& use : report_.materials) {
            surface += use.area;
        }
        const std::size_t count = report_.reversed_triangles.size();
        if (count == 0) {
            return;
        }
        if (area > kInsideOutShare * surface) {
            add(Severity::questionable,
                "the model is inside out: " + counted(count, "triangle shows", "triangles show") +
                    " only the back to the air, " + percent(area / surface) +
                    " of its surface (harmless unless a material is one-sided)");
            return;
        }
        add(Severity::questionable,
            counted(count, "face is", "faces are") + " reversed, " + short_text(area) +
                " m2, the first (triangle " +
                std::to_string(report_.reversed.front().first_triangle) + ") near " +
                place_text(report_.reversed.front().place.centre));
    }

    void add_doubled() {
        std::size_t same = 0;
        std::size_t reversed = 0;
        for (const FaceGroup& group : report_.doubled) {
            (group.is_reversed ? reversed : same) += group.triangles;
        }
        if (same + reversed == 0) {
            return;
        }
        add(Severity::questionable,
            counted(same + reversed, "face is", "faces are") + " doubled (" +
                std::to_string(reversed) + " reversed), the first near " +
                place_text(report_.doubled.front().place.centre) +
                "; the first material in the file counts");
    }

    void add_materials() {
        const auto has_origin = [this](MaterialOrigin origin) {
            std::vector<std::size_t> indices;
            for (std::size_t i = 0; i < report_.materials.size(); ++i) {
                // Without sampling no area is known.
                if (report_.materials[i].origin == origin) {
                    indices.push_back(i);
                }
            }
            return indices;
        };
        add_material_group(Severity::questionable,
                           has_origin(MaterialOrigin::none),
                           "has no acoustic data and takes absorption 0.1",
                           "have no acoustic data and take absorption 0.1");
        add_material_group(Severity::note,
                           has_origin(MaterialOrigin::by_name),
                           "has the library's data by its name alone",
                           "have the library's data by their names alone");
        std::map<std::string, std::vector<std::size_t>> doubtful;
        for (std::size_t i = 0; i < report_.materials.size(); ++i) {
            for (const std::string& doubt : report_.materials[i].doubts) {
                doubtful[doubt].push_back(i);
            }
        }
        for (const auto& [doubt, materials] : doubtful) {
            add_material_group(severity_of(doubt, materials),
                               materials,
                               doubt + " at any frequency",
                               plural_of(doubt) + " at any frequency");
        }
    }

    /// What absorbs nothing or everything is hardly meant, but for the sky.
    Severity severity_of(const std::string& doubt,
                         const std::vector<std::size_t>& materials) const {
        const bool is_extreme = doubt == kAbsorbsNothing || (doubt == kAbsorbsEverything &&
                                                             report_.kind != ModelKind::outdoors);
        const bool is_heard = std::any_of(materials.begin(), materials.end(), [&](std::size_t i) {
            return report_.materials[i].area > 0.0;
        });
        return is_extreme && is_heard ? Severity::questionable : Severity::note;
    }

    /// "absorbs nothing" of several: "absorb nothing".
    static std::string plural_of(const std::string& doubt) {
        const std::size_t verb = doubt.find(' ');
        return doubt.substr(0, verb - 1) + doubt.substr(verb);
    }

    /// How many, which, and what they matter.
    void add_material_group(Severity severity,
                            const std::vector<std::size_t>& materials,
                            const std::string& one,
                            const std::string& many) {
        if (materials.empty()) {
            return;
        }
        std::string names;
        double area = 0.0;
        double share = 0.0;
        for (std::size_t k = 0; k < materials.size(); ++k) {
            if (k < kMaxOfKind) {
                names += (k > 0 ? ", \"" : "\"") + scene_.materials[materials[k]].name + "\"";
            }
            area += report_.materials[materials[k]].area;
            share += report_.materials[materials[k]].absorption_share;
        }
        add(severity,
            counted(materials.size(), "material", "materials") + " " +
                (materials.size() == 1 ? one : many) + ": " + names +
                (materials.size() > kMaxOfKind ? ", ..." : "") + ", " + short_text(area) + " m2, " +
                percent(share) + " of the absorption");
    }

    void add_notes() {
        if (report_.is_open) {
            add(Severity::note, "the model is open: sound leaves it, as outdoors");
        }
        if (!report_.unreached.empty()) {
            add(Severity::note,
                counted(report_.unreached.size(), "triangle", "triangles") + " not reached by " +
                    std::to_string(report_.rays) + " rays, " +
                    (report_.proven_unreached.size() == report_.unreached.size()
                         ? std::string("all")
                         : std::to_string(report_.proven_unreached.size())) +
                    " proved to be out of reach");
        }
        const geometry::MeshTopology& topology = report_.topology;
        std::size_t leaking = 0;
        for (const Leak& leak : report_.leaks) {
            leaking += leak.hole != Leak::kNoHole ? 1 : 0;
        }
        if (topology.holes.size() > leaking) {
            add(Severity::note,
                counted(topology.holes.size() - leaking, "border", "borders") +
                    " of sheets or holes through which nothing leaks");
        }
        if (!topology.flipped.empty()) {
            add(Severity::note,
                counted(topology.flipped.size(), "triangle has", "triangles have") +
                    " another winding than their neighbours");
        }
        if (!topology.t_junctions.empty()) {
            add(Severity::note,
                counted(topology.t_junctions.size(), "T-junction", "T-junctions") +
                    ", the first at " + place_text(topology.t_junctions.front().position));
        }
        if (!topology.slivers.empty()) {
            add(Severity::note,
                counted(topology.slivers.size(), "sliver", "slivers") + ", the first at " +
                    place_text(topology.slivers.front().centre));
        }
        for (const SmallFacets& small : report_.small_facets) {
            if (small.frequency_hz == 1000.0 && small.area_share >= kMinSmallShare) {
                add(Severity::note,
                    counted(small.facets, "facet", "facets") + " under " +
                        short_text(small.half_wavelength) +
                        " m, half a wavelength at 1 kHz: specular paths are not physical there");
            }
        }
    }

    const Scene& scene_;
    const ModelReport& report_;
    bool has_unit_option_;
    std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> model_findings(const Scene& scene,
                                    const ModelReport& report,
                                    bool has_unit_option) {
    return Writer(scene, report, has_unit_option).write();
}

Severity gravest(std::span<const Finding> findings) {
    Severity severity = Severity::note;
    for (const Finding& finding : findings) {
        severity = std::max(severity, finding.severity);
    }
    return severity;
}

}  // namespace earshot::propagation
