// SPDX-License-Identifier: MIT
#include "earshot/visibility/item_buffer.h"

#include "earshot/base/assert.h"
#include "earshot/geometry/vector.h"
#include "earshot/visibility/internal/directions.h"
#include "earshot/visibility/internal/masked_hits.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

namespace earshot::visibility {

using geometry::Hit;
using geometry::Ray;
using geometry::Vec3;

namespace {

/// The ray through a pixel's middle.
class Lens {
public:
    Lens(const View& view, const Vec3& point) noexcept : view_(view), point_(point) {
        if (!view.forward) {
            return;
        }
        front_ = geometry::normalized(*view.forward);
        const Vec3 across = glm::cross(front_, Vec3(0.0, 1.0, 0.0));
        // Straight up or down: right is +X, as it is for all that looks along -Z.
        right_ =
            glm::dot(across, across) > 0.0 ? geometry::normalized(across) : Vec3(1.0, 0.0, 0.0);
        up_ = glm::cross(right_, front_);
        half_width_ =
            view.parallel_width ? *view.parallel_width / 2.0 : math::tan(view.field_of_view / 2.0);
    }

    Ray ray(std::size_t row, std::size_t column) const noexcept {
        // From -1 to 1 over the width; rows have the same scale.
        const auto width = static_cast<double>(view_.width);
        const auto height = static_cast<double>(view_.height);
        const double x = (2.0 * static_cast<double>(column) + 1.0 - width) / width;
        const double y = (height - 2.0 * static_cast<double>(row) - 1.0);
        if (view_.forward) {
            const Vec3 across = half_width_ * (x * right_ + y / width * up_);
            if (view_.parallel_width) {
                return {.origin = point_ + across, .direction = front_};
            }
            return {.origin = point_, .direction = geometry::normalized(front_ + across)};
        }
        const double azimuth = x * math::kPi;
        const double elevation = y / height * math::kPi / 2.0;
        const double level = math::cos(elevation);
        return {
            .origin = point_,
            .direction = geometry::normalized(
                {level * math::sin(azimuth), math::sin(elevation), -level * math::cos(azimuth)})};
    }

private:
    const View& view_;
    const Vec3& point_;
    Vec3 front_{0.0}, right_{0.0}, up_{0.0};
    double half_width_ = 1.0;
};

}  // namespace

ItemBuffer render_item_buffer(const bvh::MeshBvh& bvh,
                              const Vec3& point,
                              const View& view,
                              const ExclusionMask& excluded,
                              Executor& executor,
                              Progress* progress) {
    EARSHOT_ASSERT(view.width > 0 && view.height > 0);
    EARSHOT_ASSERT(view.field_of_view > 0.0 && view.field_of_view < math::kPi);
    constexpr std::size_t kPixelsPerBatch = std::size_t{1} << 16U;
    EARSHOT_ASSERT(!view.parallel_width || (view.forward && *view.parallel_width > 0.0));
    const Lens lens(view, point);
    const std::size_t rows_per_batch = std::max<std::size_t>(1, kPixelsPerBatch / view.width);
    const std::size_t pixels = view.width * view.height;
    ItemBuffer buffer{
        .view = view, .directions = std::vector<Vec3>(pixels), .triangles = {}, .distances = {}};
    buffer.triangles.reserve(pixels);
    buffer.distances.reserve(pixels);
    const ExclusionMask absent = with_degenerate(excluded, bvh.mesh());
    std::vector<Ray> rays;
    std::vector<std::optional<Hit>> hits;
    for (std::size_t row = 0; row < view.height; row += rows_per_batch) {
        const std::size_t rows = std::min(rows_per_batch, view.height - row);
        const std::size_t first = row * view.width;
        rays.resize(rows * view.width);
        executor.for_each(rows, 1, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin * view.width; i < end * view.width; ++i) {
                rays[i] = lens.ray(row + i / view.width, i % view.width);
                buffer.directions[first + i] = rays[i].direction;
            }
        });
        hits.resize(rays.size());
        closest_hits(bvh, rays, absent, hits, executor);
        for (const std::optional<Hit>& hit : hits) {
            buffer.triangles.push_back(hit ? hit->triangle : kNoTriangle);
            buffer.distances.push_back(hit ? hit->t : std::numeric_limits<double>::infinity());
        }
        if (progress != nullptr) {
            progress->report("picture", row + rows, view.height);
        }
    }
    return buffer;
}

}  // namespace earshot::visibility
