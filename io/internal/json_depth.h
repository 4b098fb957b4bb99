// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace earshot::io {

/// Levels that JSON text of files may be nested: tinygltf, and all that copies, compares or writes
/// JSON, is recursive.
inline constexpr int kMaxJsonDepth = 100;

/// Whether a text, JSON or not, opens more brackets outside of strings than that.
bool exceeds_json_depth(std::string_view text) noexcept;

}  // namespace earshot::io
