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

/// How finely a frustum is searched again, at most `max_pieces`: a piece for two facets or more.
int pieces_for(std::size_t facets, int max_pieces) noexcept {
    if (facets < kMinFacets) {
        return 1;
    }
    int pieces = max_pieces;
    while (static_cast<std::size_t>(2 * pieces * pieces) > facets) {
        pieces /= 2;
    }
    return pieces;
}

/// A piece of a frustum, one of `side` x `side`.
struct Piece {
    std::size_t frustum = 0;
    int side = 1;
    int row = 0, column = 0;
};

Frustum narrowed(const Frustum& frustum, const Piece& piece) {
    const glm::dvec2 size =
        (frustum.rect.upper - frustum.rect.lower) / static_cast<double>(piece.side);
    const glm::dvec2 lower = frustum.rect.lower + glm::dvec2(piece.column, piece.row) * size;
    Frustum narrow = frustum;
    narrow.rect = {.lower = lower - kApertureSlack, .upper = lower + size + kApertureSlack};
    return narrow;
}

/// The cells of the whole frustum in which cells of a piece lie. Both have eight rows and columns.
CellMask cells_of_whole(CellMask cells, const Piece& piece) noexcept {
    CellMask whole = 0;
    for_each_cell(cells, [&](int cell) {
        const int row = (kGridSide * piece.row + cell / kGridSide) / piece.side;
        const int column = (kGridSide * piece.column + cell % kGridSide) / piece.side;
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

/// The pieces of all frusta in which there are many facets, those of a frustum in a row.
std::vector<Piece> pieces_of(std::span<const std::vector<VisibleFacet>> visible, int max_pieces) {
    std::vector<Piece> all;
    for (std::size_t i = 0; i < visible.size(); ++i) {
        const int side = pieces_for(visible[i].size(), max_pieces);
        for (int row = 0; side > 1 && row < side; ++row) {
            for (int column = 0; column < side; ++column) {
                all.push_back({i, side, row, column});
            }
        }
    }
    return all;
}

}  // namespace

std::vector<std::vector<VisibleFacet>> find_primary_facets(
    std::span<const Frustum> frusta,
    int max_pieces,
    const std::function<VisibleFacets()>& make_search,
    Executor& executor) {
    EARSHOT_ASSERT(std::has_single_bit(static_cast<unsigned>(max_pieces)));
    std::vector<std::vector<VisibleFacet>> visible(frusta.size());
    executor.for_each(frusta.size(), 1, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = make_search();
        for (std::size_t i = begin; i < end; ++i) {
            search.search(frusta[i]);
            visible[i] = search.found();
        }
    });
    const std::vector<Piece> narrow = pieces_of(visible, max_pieces);
    constexpr std::size_t kGrain = 8;
    std::vector<std::vector<VisibleFacet>> found(narrow.size());
    executor.for_each(narrow.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        VisibleFacets search = make_search();
        for (std::size_t i = begin; i < end; ++i) {
            const Frustum& whole = frusta[narrow[i].frustum];
            search.search(narrowed(whole, narrow[i]));
            found[i] = search.found();
            for (VisibleFacet& part : found[i]) {
                part.cells = cells_of_whole(part.cells, narrow[i]);
                if (part.grazing) {
                    part.aperture = whole.rect;
                    part.cells = whole.active;
                }
            }
        }
    });
    executor.for_each(frusta.size(), 1, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            std::vector<VisibleFacet> parts;
            auto piece =
                std::partition_point(narrow.begin(), narrow.end(), [&](const Piece& other) {
                    return other.frustum < i;
                });
            const bool has_pieces = piece != narrow.end() && piece->frustum == i;
            for (; piece != narrow.end() && piece->frustum == i; ++piece) {
                const auto& some = found[static_cast<std::size_t>(piece - narrow.begin())];
                parts.insert(parts.end(), some.begin(), some.end());
            }
            if (has_pieces) {
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
