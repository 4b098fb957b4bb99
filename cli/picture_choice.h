// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/cli/arguments.h"
#include "earshot/cli/scene_choice.h"
#include "earshot/geometry/mesh.h"
#include "earshot/io/png.h"
#include "earshot/propagation/scene.h"
#include "earshot/visibility/item_buffer.h"

#include <optional>
#include <string>

namespace earshot::cli {

/// The options of a picture of what is visible from a point.
class PictureChoice {
public:
    /// Must outlive the parsing of the command line.
    void add_to(CLI::App& app);

    bool is_chosen() const noexcept { return !file_.empty(); }
    const std::string& file() const noexcept { return file_; }

    /// The projection of a picture from `point`, in the axes of `scene`. Throws UsageError if an
    /// option is not of its form.
    visibility::View view_from(const CLI::App& app,
                               const SceneChoice& scene,
                               const geometry::Vec3& point) const;

    /// What was seen, painted; `mesh` is where it was then. If --depth-range is not given, the
    /// first picture sets it for all.
    io::Picture paint(const visibility::ItemBuffer& buffer,
                      const geometry::MeshView& mesh,
                      const propagation::Scene& scene);

    /// Whether materials have colours of their own, those of colour_of() of their indices.
    bool shows_materials() const noexcept { return is_chosen() && colour_ == "material"; }

    /// The distance that is darkest, metres, if distances were painted.
    std::optional<double> depth_range() const noexcept { return depth_range_; }

private:
    std::string file_, size_, look_at_, colour_ = "triangle";
    double field_of_view_ = 0.0;  // degrees; 0: not given
    double given_range_ = 0.0;    // 0: not given
    std::optional<double> depth_range_;
};

}  // namespace earshot::cli
