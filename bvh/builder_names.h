// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/bvh/tree.h"

#include <optional>
#include <span>
#include <string_view>

namespace earshot::bvh {

/// A builder as users write it.
struct NamedBuilder {
    Builder builder = Builder::binned_sah;
    std::string_view name;
    std::string_view summary;  ///< half a sentence for help texts
};

/// All builders, the default first.
std::span<const NamedBuilder> named_builders() noexcept;

/// The builder of that name, if there is one.
std::optional<NamedBuilder> builder_named(std::string_view name) noexcept;

}  // namespace earshot::bvh
