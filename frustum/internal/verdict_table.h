// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/frustum/internal/geometry_change.h"
#include "earshot/frustum/path_verifier.h"
#include "earshot/frustum/paths.h"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace earshot::frustum {

/// What the verification of candidates of one source came to, each with a witness by which it can
/// be told whether a change concerns it:
///
///     no_reflection     holds as long as the facets of the sequence are unchanged
///     blocked           likewise, and that of the occluder
///     blocked_by_layer  never taken over
///     path              holds as long as they are unchanged and no swept box meets a leg
///
/// Verification of a sequence reads its facets, and the triangles that its legs touch; so these are
/// the same verdicts, to the last bit, as those of a verification anew.
class VerdictTable {
public:
    struct Verdict {
        std::optional<Rejection> rejection;  ///< none: `path`
        const SpecularPath* path = nullptr;
    };

    /// The verdict on a sequence for a listener; nothing if it is not in the table.
    std::optional<Verdict> find(std::span<const geometry::FacetId> sequence,
                                std::size_t listener) const;

    /// To be followed by finish() before find().
    void add(std::span<const geometry::FacetId> sequence,
             std::size_t listener,
             const Rejection& rejection);
    void add(std::span<const geometry::FacetId> sequence,
             std::size_t listener,
             const SpecularPath& path);
    void append(VerdictTable&& other);
    void finish();

    std::size_t size() const noexcept { return entries_.size(); }
    std::size_t bytes() const noexcept;

private:
    struct Entry {
        std::uint32_t first_facet = 0;  // into facets_
        std::uint32_t order = 0;
        std::uint32_t listener = 0;
        std::uint32_t witness = 0;  // an occluder, or a path
        std::uint8_t kind = 0;      // a Rejection::Reason, or kPath
    };
    static constexpr std::uint8_t kPath = 255;

    void add(std::span<const geometry::FacetId> sequence,
             std::size_t listener,
             std::uint8_t kind,
             std::uint32_t witness);
    std::uint64_t hash(std::span<const geometry::FacetId> sequence,
                       std::size_t listener) const noexcept;

    std::vector<Entry> entries_;
    std::vector<geometry::FacetId> facets_;
    std::vector<SpecularPath> paths_;
    std::vector<std::uint32_t> slots_;  // a hash table, open addressing: an entry + 1, 0: none
};

/// The verdicts of the instant before, as far as a change leaves them.
class FormerVerdicts {
public:
    /// `change`: null if nothing has changed. Both must outlive it.
    FormerVerdicts(const VerdictTable& table, const GeometryChange* change)
        : table_(&table), change_(change) {}

    /// The verdict that a verification anew would come to; nothing if that takes it.
    /// `sequence`: by the numbers of now.
    std::optional<VerdictTable::Verdict> find(std::span<const geometry::FacetId> sequence,
                                              std::size_t listener) const;

private:
    bool still_holds(const VerdictTable::Verdict& verdict) const;

    const VerdictTable* table_;
    const GeometryChange* change_;
};

}  // namespace earshot::frustum
