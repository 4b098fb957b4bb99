// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/beam_tree.h"
#include "earshot/frustum/internal/geometry_change.h"
#include "earshot/frustum/internal/kept_connections.h"
#include "earshot/frustum/internal/kept_frusta.h"
#include "earshot/frustum/internal/primary_facets.h"

#include <numeric>
#include <utility>

namespace earshot::frustum {

namespace {

/// A node of the beam tree before the change.
struct OldNode {
    const BeamTree* tree = nullptr;
    std::size_t index = 0;
    std::size_t first = 0;  // visible facets of the parts before this one

    const BeamNode& node() const { return tree->nodes[index]; }
    std::span<const VisibleFacet> visible() const { return tree->visible_in(node()); }
    /// Of its visible facets, over all parts.
    std::uint32_t first_position() const {
        return static_cast<std::uint32_t>(first + node().visible_begin);
    }

    /// Calls visit(child) for each, in order. Nodes are in depth-first order: the descendants come
    /// after the node, up to one that is no deeper.
    template <typename Visit>
    void for_each_child(Visit&& visit) const {
        const std::size_t order = node().order;
        for (std::size_t i = index + 1; i < tree->nodes.size() && tree->nodes[i].order > order;
             ++i) {
            if (tree->nodes[i].order == order + 1) {
                visit(OldNode{tree, i, first});
            }
        }
    }
};

void add_to_positions(std::uint32_t first, std::span<std::uint32_t> positions) {
    for (std::uint32_t& position : positions) {
        position += position != kNotBefore ? first : 0;
    }
}

/// A frustum of order 1, and its node before the change if there was one.
struct Subtree {
    Frustum frustum;
    OldNode old;
};

}  // namespace

/// Goes down the beam trees before and after a change together.
class BeamTracer::Update {
public:
    Update(const BeamTracer& tracer, const GeometryChange& change)
        : tracer_(tracer), change_(change) {
        for (int order = 0; order < tracer.orders_; ++order) {
            searches_.push_back(tracer.make_search());
        }
        lookups_.resize(searches_.size());
    }

    /// A frustum that there was, by its numbers of now, and all below it.
    void update_subtree(const Frustum& frustum, const OldNode& old) {
        if (update_node(frustum, old)) {
            // The frusta that it reflects are the same too.
            old.for_each_child([&](const OldNode& child) {
                Frustum same = child.node().frustum;
                same.facet = change_.after(same.facet);
                recorder_.push(same.facet);
                update_subtree(same, child);
                recorder_.pop();
            });
            return;
        }
        const std::size_t order = recorder_.order();
        if (static_cast<int>(order) + 1 >= tracer_.orders_) {
            return;
        }
        FrustumLookup& lookup = lookups_[order];
        lookup.clear();
        old.for_each_child(
            [&](const OldNode& child) { lookup.add(child.node().frustum, child.index, change_); });
        lookup.finish();
        VisibleFacets& search = searches_[order];
        for (const VisibleFacet& visible : search.found()) {
            if (tracer_.may_reflect(search.frustum(), visible)) {
                const Frustum child = search.reflect(visible);
                const auto known = lookup.find(child);
                update_or_trace({child, known ? OldNode{old.tree, *known, old.first} : OldNode{}});
            }
        }
    }

    void update_or_trace(const Subtree& subtree) {
        recorder_.push(subtree.frustum.facet);
        if (subtree.old.tree != nullptr) {
            update_subtree(subtree.frustum, subtree.old);
        } else {
            tracer_.trace_subtree(subtree.frustum, searches_, recorder_);
        }
        recorder_.pop();
    }

    std::uint64_t kept_frusta() const { return kept_frusta_; }
    BeamTree take_tree() { return recorder_.take_tree(); }

private:
    /// The frustum alone; whether it was kept. Either way it is the current one of the search.
    bool update_node(const Frustum& frustum, const OldNode& old) {
        VisibleFacets& search = searches_[recorder_.order()];
        search.set_frustum(frustum);
        const OccluderDepths& occluders = old.node().occluders;
        if (are_still_visible(search, old.visible(), occluders, change_)) {
            renumbered_.clear();
            append_renumbered(old.visible(), change_, renumbered_);
            positions_.resize(renumbered_.size());
            std::iota(positions_.begin(), positions_.end(), old.first_position());
            recorder_.record(frustum, renumbered_, occluders, false, positions_);
            ++kept_frusta_;
            return true;
        }
        search.search(frustum);
        positions_.clear();
        append_positions_before(search.found(), old.visible(), change_, positions_);
        add_to_positions(old.first_position(), positions_);
        recorder_.record(frustum, search.found(), search.occluder_depths(), false, positions_);
        return false;
    }

    const BeamTracer& tracer_;
    const GeometryChange& change_;
    std::vector<VisibleFacets> searches_;   // one per order
    std::vector<FrustumLookup> lookups_;    // likewise
    std::vector<VisibleFacet> renumbered_;  // scratch
    std::vector<std::uint32_t> positions_;  // likewise
    BeamRecorder recorder_;
    std::uint64_t kept_frusta_ = 0;
};

UpdatedBeams BeamTracer::update(const geometry::Vec3& source,
                                std::span<const BeamTree> before,
                                const GeometryChange& change,
                                Executor& executor,
                                Progress* progress) const {
    // The frusta around the source are the same as before, in the same order. Of those of order 1
    // it does not matter which one they are reflections of.
    std::vector<std::vector<VisibleFacet>> primary_before;
    std::vector<std::vector<std::uint32_t>> primary_positions;  // likewise, over all parts
    std::vector<OldNode> old_subtrees;
    FrustumLookup lookup;
    std::size_t first = 0;  // visible facets of earlier parts
    for (const BeamTree& part : before) {
        for (std::size_t i = 0; i < part.nodes.size(); ++i) {
            const BeamNode& node = part.nodes[i];
            if (node.order == 0) {
                if (!node.is_continued) {
                    primary_before.emplace_back();
                    primary_positions.emplace_back();
                }
                const auto visible = part.visible_in(node);
                primary_before.back().insert(
                    primary_before.back().end(), visible.begin(), visible.end());
                for (std::size_t k = node.visible_begin; k < node.visible_end; ++k) {
                    primary_positions.back().push_back(static_cast<std::uint32_t>(first + k));
                }
            } else if (node.order == 1) {
                lookup.add(node.frustum, old_subtrees.size(), change);
                old_subtrees.push_back({&part, i, first});
            }
        }
        first += part.visible.size();
    }
    lookup.finish();
    const auto primary = frusta_around_source(source);
    EARSHOT_ASSERT(primary.size() == primary_before.size());
    const PrimaryFacets facets = update_primary_facets(
        primary, primary_before, change, primary_pieces_, [&] { return make_search(); }, executor);
    UpdatedBeams result;
    result.kept_frusta = facets.kept_frusta();
    std::vector<std::vector<std::uint32_t>> positions(primary.size());
    for (std::size_t i = 0; i < primary.size(); ++i) {
        append_positions_before(facets.visible[i], primary_before[i], change, positions[i]);
        for (std::uint32_t& position : positions[i]) {
            position = position != kNotBefore ? primary_positions[i][position] : kNotBefore;
        }
    }
    std::vector<Subtree> subtrees;
    VisibleFacets search = make_search();
    for (const FacetRange& range : divide_facets(facets.visible)) {
        search.set_frustum(
            primary[range.frustum],
            std::span(facets.visible[range.frustum]).subspan(range.begin, range.end - range.begin));
        BeamRecorder recorder;
        recorder.record(
            search.frustum(),
            search.found(),
            {},
            range.begin > 0,
            std::span(positions[range.frustum]).subspan(range.begin, range.end - range.begin));
        result.parts.push_back(recorder.take_tree());
        for (const VisibleFacet& visible : search.found()) {
            if (orders_ > 1 && may_reflect(search.frustum(), visible)) {
                const Frustum child = search.reflect(visible);
                const auto known = lookup.find(child);
                subtrees.push_back({child, known ? old_subtrees[*known] : OldNode{}});
            }
        }
    }
    // Everything else, subtree by subtree.
    std::vector<UpdatedBeams> of_chunk(chunk_count(subtrees.size(), kGrain));
    StageProgress traced(progress, "tracing", subtrees.size());
    executor.for_each(subtrees.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        Update update(*this, change);
        for (std::size_t i = begin; i < end; ++i) {
            update.update_or_trace(subtrees[i]);
        }
        of_chunk[begin / kGrain].kept_frusta = update.kept_frusta();
        of_chunk[begin / kGrain].parts.push_back(update.take_tree());
        traced.add(end - begin);
    });
    for (UpdatedBeams& chunk : of_chunk) {
        result.kept_frusta += chunk.kept_frusta;
        result.parts.push_back(std::move(chunk.parts.front()));
    }
    return result;
}

}  // namespace earshot::frustum
