// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/verdict_table.h"

#include "earshot/base/random.h"

#include <algorithm>
#include <array>
#include <bit>
#include <iterator>
#include <utility>

namespace earshot::frustum {

using geometry::FacetId;
using geometry::Vec3;

std::uint64_t VerdictTable::hash(std::span<const FacetId> sequence,
                                 std::size_t listener) const noexcept {
    std::uint64_t value = listener;
    for (const FacetId facet : sequence) {
        value = random_bits(value, facet, sequence.size());
    }
    return random_bits(value, sequence.size(), listener);
}

std::optional<VerdictTable::Verdict> VerdictTable::find(std::span<const FacetId> sequence,
                                                        std::size_t listener) const {
    if (slots_.empty()) {
        return std::nullopt;
    }
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t slot = hash(sequence, listener) & mask; slots_[slot] != 0;
         slot = (slot + 1) & mask) {
        const Entry& entry = entries_[slots_[slot] - 1];
        const auto facets = std::span(facets_).subspan(entry.first_facet, entry.order);
        if (entry.listener == listener && std::ranges::equal(facets, sequence)) {
            if (entry.kind == kPath) {
                return Verdict{std::nullopt, &paths_[entry.witness]};
            }
            return Verdict{Rejection{static_cast<Rejection::Reason>(entry.kind), entry.witness},
                           nullptr};
        }
    }
    return std::nullopt;
}

void VerdictTable::add(std::span<const FacetId> sequence,
                       std::size_t listener,
                       std::uint8_t kind,
                       std::uint32_t witness) {
    entries_.push_back({static_cast<std::uint32_t>(facets_.size()),
                        static_cast<std::uint32_t>(sequence.size()),
                        static_cast<std::uint32_t>(listener),
                        witness,
                        kind});
    facets_.insert(facets_.end(), sequence.begin(), sequence.end());
}

void VerdictTable::add(std::span<const FacetId> sequence,
                       std::size_t listener,
                       const Rejection& rejection) {
    add(sequence, listener, static_cast<std::uint8_t>(rejection.reason), rejection.occluder);
}

void VerdictTable::add(std::span<const FacetId> sequence,
                       std::size_t listener,
                       const SpecularPath& path) {
    add(sequence, listener, kPath, static_cast<std::uint32_t>(paths_.size()));
    paths_.push_back(path);
}

void VerdictTable::append(VerdictTable&& other) {
    const auto facets = static_cast<std::uint32_t>(facets_.size());
    const auto paths = static_cast<std::uint32_t>(paths_.size());
    for (Entry entry : other.entries_) {
        entry.first_facet += facets;
        entry.witness += entry.kind == kPath ? paths : 0;
        entries_.push_back(entry);
    }
    facets_.insert(facets_.end(), other.facets_.begin(), other.facets_.end());
    std::move(other.paths_.begin(), other.paths_.end(), std::back_inserter(paths_));
}

// At most half of the slots are taken. One sequence may have been verified twice, in two frusta;
// then the first entry is found.
void VerdictTable::finish() {
    slots_.assign(std::bit_ceil(2 * entries_.size() + 2), 0);
    const std::size_t mask = slots_.size() - 1;
    for (std::size_t i = 0; i < entries_.size(); ++i) {
        const Entry& entry = entries_[i];
        const auto facets = std::span(facets_).subspan(entry.first_facet, entry.order);
        std::size_t slot = hash(facets, entry.listener) & mask;
        while (slots_[slot] != 0) {
            slot = (slot + 1) & mask;
        }
        slots_[slot] = static_cast<std::uint32_t>(i + 1);
    }
}

std::size_t VerdictTable::bytes() const noexcept {
    std::size_t bytes = entries_.size() * sizeof(Entry) + facets_.size() * sizeof(FacetId) +
                        slots_.size() * sizeof(slots_.front());
    for (const SpecularPath& path : paths_) {
        bytes += sizeof(SpecularPath) + path.points.size() * (sizeof(Vec3) + sizeof(FacetId));
    }
    return bytes;
}

std::optional<VerdictTable::Verdict> FormerVerdicts::find(std::span<const FacetId> sequence,
                                                          std::size_t listener) const {
    if (change_ == nullptr) {
        return table_->find(sequence, listener);
    }
    constexpr std::size_t kMaxOrder = 64;  // of TraceOptions
    std::array<FacetId, kMaxOrder> before{};
    for (std::size_t i = 0; i < sequence.size(); ++i) {
        before[i] = change_->before(sequence[i]);
        if (before[i] == GeometryChange::kChanged) {
            return std::nullopt;
        }
    }
    auto verdict = table_->find(std::span(before).first(sequence.size()), listener);
    return verdict && still_holds(*verdict) ? verdict : std::nullopt;
}

bool FormerVerdicts::still_holds(const VerdictTable::Verdict& verdict) const {
    if (verdict.rejection) {
        switch (verdict.rejection->reason) {
            case Rejection::Reason::no_reflection:
                return true;
            case Rejection::Reason::blocked:
                return change_->is_unchanged(verdict.rejection->occluder);
            case Rejection::Reason::blocked_by_layer:
                return false;
        }
    }
    // The legs that were verified, from one reflection to the next: points of transmissions lie on
    // them up to rounding only.
    const SpecularPath& path = *verdict.path;
    Vec3 from = path.points.front();
    for (std::size_t i = 1; i < path.points.size(); ++i) {
        const bool is_transmission =
            i + 1 < path.points.size() && !path.transmitted.empty() && path.transmitted[i - 1] != 0;
        if (!is_transmission) {
            if (change_->may_touch({from, path.points[i]})) {
                return false;
            }
            from = path.points[i];
        }
    }
    return true;
}

}  // namespace earshot::frustum
