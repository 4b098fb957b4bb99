// SPDX-License-Identifier: MIT
#include "earshot/cli/picture_choice.h"

#include "earshot/base/math.h"
#include "earshot/cli/values.h"
#include "earshot/cli/visible_picture.h"

namespace earshot::cli {

void PictureChoice::add_to(CLI::App& app) {
    app.add_option("--image", file_, "write a .png picture of the visible triangles");
    app.add_option("--image-size",
                   size_,
                   "pixels, WIDTH or WIDTHxHEIGHT; default: 1024x512, with --look-at 1024x768");
    app.add_option(
        "--look-at", look_at_, "X,Y,Z at the centre of the picture; default: all directions");
    add_number(app,
               "--field-of-view",
               field_of_view_,
               {1.0, 170.0},
               "horizontal field of view, degrees; default with --look-at: 90");
    app.add_option("--colour,--color", colour_, "what colours show: triangle, material or depth")
        ->check(CLI::IsMember({"triangle", "material", "depth"}));
    add_number(app,
               "--depth-range",
               given_range_,
               {1e-6, 1e12},
               "distance of the darkest grey, metres; default: the largest");
}

visibility::View PictureChoice::view_from(const CLI::App& app,
                                          const SceneChoice& scene,
                                          const geometry::Vec3& point) const {
    visibility::View view;
    if (!look_at_.empty()) {
        const auto target = parse_point(look_at_);
        if (!target) {
            throw wrong_usage(app, "--look-at", "'" + look_at_ + "' is not of the form X,Y,Z");
        }
        view.forward = scene.to_scene(*target) - point;
        if (*view.forward == geometry::Vec3(0.0)) {
            throw wrong_usage(app, "--look-at", "is the viewpoint itself");
        }
    } else if (field_of_view_ > 0.0) {
        view.forward = geometry::Vec3(0.0, 0.0, -1.0);
    }
    if (field_of_view_ > 0.0) {
        view.field_of_view = field_of_view_ * math::kPi / 180.0;
    }
    const bool is_panorama = !view.forward;
    view.height = is_panorama ? 512 : 768;
    if (!size_.empty()) {
        const auto size = parse_picture_size(size_, static_cast<std::int64_t>(io::kMaxPictureSize));
        if (!size) {
            throw wrong_usage(app,
                              "--image-size",
                              "'" + size_ + "' is not WIDTH or WIDTHxHEIGHT in 1 ... " +
                                  std::to_string(io::kMaxPictureSize));
        }
        view.width = static_cast<std::size_t>(size->width);
        const std::size_t usual = is_panorama ? (view.width + 1) / 2 : (view.width * 3 + 3) / 4;
        view.height = size->height ? static_cast<std::size_t>(*size->height) : usual;
    }
    return view;
}

io::Picture PictureChoice::paint(const visibility::ItemBuffer& buffer,
                                 const geometry::MeshView& mesh,
                                 const propagation::Scene& scene) {
    if (colour_ == "triangle") {
        return paint_triangles(buffer);
    }
    if (colour_ == "material") {
        return paint_materials(buffer, mesh, scene.material_of_triangle);
    }
    if (!depth_range_) {
        depth_range_ = given_range_ > 0.0 ? given_range_ : farthest(buffer);
    }
    return paint_depths(buffer, *depth_range_);
}

}  // namespace earshot::cli
