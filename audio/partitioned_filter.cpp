// SPDX-License-Identifier: MIT
#include "earshot/audio/partitioned_filter.h"

#include "earshot/audio/internal/arrival_mixing_kernel.h"
#include "earshot/audio/internal/block_transform.h"

#include <algorithm>
#include <vector>

namespace earshot::audio {

PartitionedFilter::PartitionedFilter(std::span<const double> taps, std::size_t block)
    : parts_((taps.size() + block - 1) / block),
      stride_(spectrum_stride(block)),
      numbers_(parts_ * 2 * stride_) {
    BlockTransform transform(block);
    for (std::size_t part = 0; part < parts_; ++part) {
        const std::size_t begin = part * block;
        transform.forward_of_filter(taps.data() + begin,
                                    std::min(block, taps.size() - begin),
                                    &numbers_[part * 2 * stride_]);
    }
}

struct MatrixConvolver::State {
    explicit State(const Settings& the_settings)
        : settings(the_settings),
          transform(the_settings.block),
          windows(settings.inputs * settings.max_parts * row(), 0.0F),
          last_blocks(settings.inputs * settings.block, 0.0F),
          sum(row(), 0.0F) {}

    /// Numbers of a spectrum.
    std::size_t row() const noexcept { return 2 * transform.stride(); }
    float* window(std::size_t input, std::size_t age) noexcept {
        const std::size_t place = (newest + age) % settings.max_parts;
        return &windows[(input * settings.max_parts + place) * row()];
    }

    Settings settings;
    BlockTransform transform;
    LargeArray<float> windows;  // per input a ring of spectra
    std::size_t newest = 0;     // place in every ring
    std::vector<float> last_blocks;
    LargeArray<float> sum;
};

MatrixConvolver::MatrixConvolver(const Settings& settings)
    : state_(std::make_unique<State>(settings)) {}
MatrixConvolver::~MatrixConvolver() = default;
MatrixConvolver::MatrixConvolver(MatrixConvolver&&) noexcept = default;
MatrixConvolver& MatrixConvolver::operator=(MatrixConvolver&&) noexcept = default;

void MatrixConvolver::process(const PartitionedFilter* filters,
                              const float* in,
                              float* out) noexcept {
    State& state = *state_;
    const Settings& settings = state.settings;
    const std::size_t block = settings.block;
    state.newest = (state.newest + settings.max_parts - 1) % settings.max_parts;
    for (std::size_t input = 0; input < settings.inputs; ++input) {
        float* last = &state.last_blocks[input * block];
        state.transform.forward(last, in + input * block, state.window(input, 0));
        std::copy(in + input * block, in + (input + 1) * block, last);
    }
    for (std::size_t output = 0; output < settings.outputs; ++output) {
        std::fill(state.sum.begin(), state.sum.end(), 0.0F);
        for (std::size_t input = 0; input < settings.inputs; ++input) {
            const PartitionedFilter& filter = filters[input * settings.outputs + output];
            const std::size_t parts = std::min(filter.parts(), settings.max_parts);
            // The ring of windows, from the newest to its end and on from its begin.
            const std::size_t to_end = std::min(parts, settings.max_parts - state.newest);
            const std::size_t stride = state.transform.stride();
            add_complex_products(
                filter.spectrum(0), state.window(input, 0), to_end, stride, state.sum.data());
            add_complex_products(filter.spectrum(to_end),
                                 state.window(input, to_end),
                                 parts - to_end,
                                 stride,
                                 state.sum.data());
        }
        state.transform.inverse(state.sum.data(), out + output * block);
    }
}

}  // namespace earshot::audio
