// SPDX-License-Identifier: MIT
#include "earshot/frustum/internal/primary_facets.h"

#include "earshot/base/assert.h"

#include <glm/common.hpp>

#include <algorithm>
#include <bit>

namespace earshot::frustum {

namespace {

/// With fewer visible facets the frusta that pieces spare cost less than the pieces.
constexpr std::size_t kMinFacets = 128;

/// A piece of a frustum.
struct Piece {
    std::size_t frustum = 0;
    int row = 0, column = 0;
};

Frustum narrowed(const Frustum& frustum, const Piece& piece, int pieces) {
    const glm::dvec2 size = (frustum.rect.upper - frustum.rect.lower) / static_cast<double>(pieces);
    const glm::dvec2 lower = frustum.rect.lower + glm::dvec2(piece.column, piece.row) * size;
    Frustum narrow = frustum;
    narrow.rect = {.lower = lower - kApertureSlack, .upper = lower + size + kApertureSlack};
    return narrow;
}

/// The cells of the whole frustum in which cells of a piece lie. Both have eight rows and columns.
CellMask cells_of_whole(CellMask cells, const Piece& piece, int pieces) noexcept {
    CellMask whole = 0;
    for_each_cell(cells, [&](int cell) {
        const int row = (kGridSide * piece.row + cell / kGridSide) / pieces;
        const int column = (kGridSide * piece.column + cell % kGridSide) / pieces;
        whole |= CellMask{1} << (kGridSide * row + column);
    });
    return whole;
}

/// Joins what the pieces of a frustum have found, facet by facet.
std::vector<VisibleFacet> joined(std::vector<VisibleFacet> parts) {
    std::stable_sort(parts.begin(), parts.end(), [](const VisibleFacet& a, const VisibleFacet& b) {
        return a.facet < b.facet;
    });
    std::vector<VisibleFacet> whole;
    for (const VisibleFacet& part : parts) {
        if (whole.empty() || whole.back().facet != part.facet) {
            whole.push_back(part);
            continue;
        }
        VisibleFacet& last = whole.back();
        last.aperture.lower = glm::min(last.aperture.lower, part.aperture.lower);
        last.aperture.upper = glm::max(last.aperture.upper, part.aperture.upper);
        last.cells |= part.cells;
    }
    return whole;
}

/// The pieces of all frusta in which there are many facets.
std::vector<Piece> pieces_of(std::span<const std::vector<VisibleFacet>> visible, int pieces) {
    std::vector<Piece> all;
    for (std::size_t i = 0; i < visible.size(); ++i) {
        if (pieces > 1 && visible[i].size() >= kMinFacets) {
            for (int row = 0; row < pieces; ++row) {
                for (int column = 0; column < pieces; ++column) {
                    all.push_back({i, row, column});
                }
            }
        }
    }
    return all;
}

}  // namespace

std::vector<std::vector<VisibleFacet>> find_primary_facets(
    std::span<const Frustum> frusta,
    int pieces,
    const std::function<VisibleFacets()>& make_search,
    Executor& executor) {
    EARSHOT_ASSERT(std::has_single_bit(static_cast<unsigned>(pieces)));
    std::vector<std::vector<VisibleFacet>> visible(frusta.size());
    executor.for_each(frusta.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = make_search();
        for (std::size_t i = begin; i < end; ++i) {
            search.search(frusta[i]);
            visible[i] = search.found();
        }
    });
    const std::vector<Piece> narrow = pieces_of(visible, pieces);
    constexpr std::size_t kGrain = 8;
    std::vector<std::vector<VisibleFacet>> found(narrow.size());
    executor.for_each(narrow.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = make_search();
        for (std::size_t i = begin; i < end; ++i) {
            const Frustum& whole = frusta[narrow[i].frustum];
            search.search(narrowed(whole, narrow[i], pieces));
            found[i] = search.found();
            for (VisibleFacet& part : found[i]) {
                part.cells = cells_of_whole(part.cells, narrow[i], pieces);
                if (part.grazing) {
                    part.aperture = whole.rect;
                    part.cells = whole.active;
                }
            }
        }
    });
    // The pieces of a frustum follow each other.
    executor.for_each(frusta.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::vector<VisibleFacet> parts;
            for (std::size_t k = 0; k < narrow.size(); ++k) {
                if (narrow[k].frustum == i) {
                    parts.insert(parts.end(), found[k].begin(), found[k].end());
                }
            }
            if (pieces > 1 && visible[i].size() >= kMinFacets) {
                visible[i] = joined(std::move(parts));
            }
        }
    });
    return visible;
}

std::vector<FacetRange> divide_facets(std::span<const std::vector<VisibleFacet>> visible) {
    constexpr std::size_t kGrain = 32;
    std::vector<FacetRange> ranges;
    for (std::size_t i = 0; i < visible.size(); ++i) {
        std::size_t begin = 0;
        do {
            const std::size_t end = std::min(visible[i].size(), begin + kGrain);
            ranges.push_back({i, begin, end});
            begin = end;
        } while (begin < visible[i].size());
    }
    return ranges;
}

}  // namespace earshot::frustum
