// SPDX-License-Identifier: MIT
#include "earshot/frustum/paths.h"

#include "earshot/base/error.h"

#include <string>

namespace earshot::frustum {

void validate(const TraceOptions& options) {
    constexpr int kMaxResolution = 1024;
    constexpr int kMaxOrder = 64;
    if (options.max_order < 0 || options.max_order > kMaxOrder) {
        throw Error("order",
                    "must be 0 to " + std::to_string(kMaxOrder) + ", not " +
                        std::to_string(options.max_order));
    }
    if (!(options.max_length >= 0.0)) {
        throw Error("max_length", "must not be negative");
    }
    if (!(options.min_pressure >= 0.0)) {
        throw Error("min_pressure", "must not be negative");
    }
    if (options.resolution < 0 || options.resolution > kMaxResolution) {
        throw Error("resolution",
                    "must be 0 (the default) to " + std::to_string(kMaxResolution) + ", not " +
                        std::to_string(options.resolution));
    }
}

}  // namespace earshot::frustum
