// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/audio/filter_cache.h"
#include "earshot/audio/internal/band_filters.h"
#include "earshot/audio/internal/recently_used.h"
#include "earshot/audio/internal/workspace_pool.h"

#include <complex>
#include <vector>

namespace earshot::audio {

/// What a thread needs to filter a signal.
struct FilterWorkspace {
    FftWorkspace fft;
    LargeArray<std::complex<double>> spectrum;
    LargeArray<double> padded, filtered;
};

struct FilterCache::State {
    static constexpr std::size_t kMaxBytes = std::size_t{64} << 20;  // of each kind

    RecentlyUsed<BandFilters> band_filters{kMaxBytes};
    RecentlyUsed<ComplementaryFilters> complementary_filters{kMaxBytes};
    WorkspacePool<FilterWorkspace> workspaces;
};

}  // namespace earshot::audio
