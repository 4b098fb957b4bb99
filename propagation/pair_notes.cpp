// SPDX-License-Identifier: MIT
#include "earshot/propagation/pair_notes.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdio>
#include <string>

namespace earshot::propagation {
namespace {

bool is_blocked(const PairResult& pair) {
    return pair.arrivals.empty() &&
           std::none_of(pair.paths.begin(), pair.paths.end(), [](const Path& path) {
               return path.kind == PathKind::direct;
           });
}

}  // namespace

Warnings note_blocked_pairs(const Scene& scene, std::span<const PairResult> pairs) {
    const auto first = std::find_if(pairs.begin(), pairs.end(), is_blocked);
    if (first == pairs.end()) {
        return {};
    }
    const std::string name =
        scene.sources[first->source].name + " to " + scene.listeners[first->listener].name;
    const std::string left_out = ": what may bend round edges is left out (diffraction 1 finds it)";
    const std::ptrdiff_t blocked = std::count_if(first, pairs.end(), is_blocked);
    if (blocked == 1) {
        return {{name, "no direct path" + left_out}};
    }
    return {{scene.name,
             "no direct path in " + std::to_string(blocked) + " of " +
                 std::to_string(pairs.size()) + " pairs, the first " + name + left_out}};
}

Warnings note_sound(const PairResult& pair, const std::string& name) {
    Warnings notes;
    if (pair.paths.empty() && pair.arrivals.empty() && pair.late.energy.empty()) {
        notes.push_back({name, "no path up to the given order: the response is silent"});
    }
    if (const LateErrors& errors = pair.late_errors; !errors.reached) {
        std::array<char, 128> text{};
        std::snprintf(
            text.data(),
            text.size(),
            "after %zu rays the standard error of T30 is %.1f %%, that of the level %.2f dB",
            errors.rays,
            100.0 * errors.t30,
            errors.level_db);
        notes.push_back({name, text.data()});
    }
    return notes;
}

}  // namespace earshot::propagation
