// SPDX-License-Identifier: MIT
#include "earshot/bvh/builder_names.h"

#include <array>

namespace earshot::bvh {
namespace {

constexpr std::array kBuilders = {
    NamedBuilder{Builder::binned_sah, "binned_sah", "surface area heuristic over bins"},
    NamedBuilder{Builder::sweep_sah, "sweep_sah", "the same over all splits: slow, the reference"},
    NamedBuilder{Builder::spatial_median,
                 "spatial_median",
                 "ranges split in the middle of the longest side"},
    NamedBuilder{Builder::quality, "quality", "binned_sah, then reinsertion: the fastest queries"},
    NamedBuilder{Builder::lbvh, "lbvh", "along a Morton curve: slower queries"},
    NamedBuilder{Builder::hybrid,
                 "hybrid",
                 "small clusters along the curve, joined by binned_sah, then reinsertion"},
    NamedBuilder{Builder::fast,
                 "fast",
                 "clusters along the curve, joined by binned_sah: the fastest to build"},
};

}  // namespace

std::span<const NamedBuilder> named_builders() noexcept {
    return kBuilders;
}

std::optional<NamedBuilder> builder_named(std::string_view name) noexcept {
    for (const NamedBuilder& builder : kBuilders) {
        if (builder.name == name) {
            return builder;
        }
    }
    return std::nullopt;
}

}  // namespace earshot::bvh
