// SPDX-License-Identifier: MIT
#include "earshot/audio/tail_convolver.h"

#include "earshot/audio/internal/arrival_mixing_kernel.h"
#include "earshot/audio/internal/block_transform.h"
#include "earshot/base/assert.h"
#include "earshot/base/large_array.h"

#include <algorithm>
#include <utility>

namespace earshot::audio {

namespace {

constexpr std::size_t kPeriod = TailConvolver::kPeriod;
// The long parts of a response begin here, in periods: what comes in during one is transformed
// during the next and heard in the one after.
constexpr std::size_t kHeadPeriods = 2;

// Work of the long parts, in products of one part and channel.
constexpr double kTransformWork = 16.0;

}  // namespace

Tail::Tail(std::span<const std::vector<double>> channels, std::size_t block) {
    const std::size_t head = kHeadPeriods * kPeriod * block;
    for (const std::vector<double>& channel : channels) {
        const std::span<const double> taps(channel);
        const std::size_t cut = std::min(head, taps.size());
        head_.emplace_back(taps.first(cut), block);
        body_.emplace_back(taps.subspan(cut), kPeriod * block);
    }
}

namespace {

/// Windows of some sources in one length of block, and what the channels have of them.
class Stage {
public:
    Stage(std::size_t sources, std::size_t channels, std::size_t block, std::size_t max_parts)
        : transform_(block),
          sources_(sources),
          max_parts_(std::max<std::size_t>(max_parts, 1)),
          windows_(sources * max_parts_ * row(), 0.0F),
          sums_(2 * channels * row(), 0.0F),
          channels_(channels) {}

    std::size_t block() const noexcept { return transform_.block(); }
    std::size_t row() const noexcept { return 2 * transform_.stride(); }

    void begin() noexcept {
        newest_ = (newest_ + max_parts_ - 1) % max_parts_;
        std::fill(sums_.begin(), sums_.end(), 0.0F);
    }
    void take(std::size_t source, const float* before, const float* now) noexcept {
        transform_.forward(before, now, window(source, 0));
    }
    /// Adds a source through a filter to the sums of a channel: those of the tails before (0), or
    /// those of the tails after (1).
    void add(std::size_t source,
             std::size_t channel,
             std::size_t version,
             const PartitionedFilter& filter) noexcept {
        // The ring of windows, from the newest to its end and on from its begin.
        const std::size_t parts = std::min(filter.parts(), max_parts_);
        const std::size_t to_end = std::min(parts, max_parts_ - newest_);
        float* to = sum(channel, version);
        add_complex_products(
            filter.spectrum(0), window(source, 0), to_end, transform_.stride(), to);
        add_complex_products(filter.spectrum(to_end),
                             window(source, to_end),
                             parts - to_end,
                             transform_.stride(),
                             to);
    }
    void hear(std::size_t channel, std::size_t version, float* signal) noexcept {
        transform_.inverse(sum(channel, version), signal);
    }
    std::size_t sources() const noexcept { return sources_; }
    std::size_t channels() const noexcept { return channels_; }

private:
    float* window(std::size_t source, std::size_t age) noexcept {
        return &windows_[(source * max_parts_ + (newest_ + age) % max_parts_) * row()];
    }
    float* sum(std::size_t channel, std::size_t version) noexcept {
        return &sums_[(version * channels_ + channel) * row()];
    }

    BlockTransform transform_;
    std::size_t sources_;
    std::size_t max_parts_;
    std::size_t newest_ = 0;
    LargeArray<float> windows_;
    LargeArray<float> sums_;
    std::size_t channels_;
};

/// What sounds during a period: the tails before and after.
struct TailPair {
    const Tail* before = nullptr;
    const Tail* after = nullptr;
};

}  // namespace

struct TailConvolver::State {
    explicit State(const Settings& the_settings)
        : settings(the_settings),
          head(settings.sources, settings.channels, settings.block, kHeadPeriods * kPeriod),
          body(settings.sources,
               settings.channels,
               kPeriod * settings.block,
               settings.max_length / (kPeriod * settings.block) + 1),
          tails(settings.sources),
          last_blocks(settings.sources * settings.block, 0.0F),
          gathered(3 * settings.sources * body.block(), 0.0F),
          heard(4 * settings.channels * body.block(), 0.0F),
          short_heard(2 * settings.block, 0.0F) {}

    bool fades() const noexcept {
        return std::any_of(tails.begin(), tails.end(), [](const TailPair& tail) {
            return tail.before != tail.after;
        });
    }
    /// What a source sent out during a period: of age 0 the one that goes on.
    float* gathered_of(std::size_t source, std::size_t age) noexcept {
        return &gathered[(((period + 3 - age) % 3) * settings.sources + source) * body.block()];
    }
    /// What the body made of a channel, in this period and in the last.
    float* heard_of(std::size_t channel, std::size_t version, std::size_t age) noexcept {
        const std::size_t half = (period + 2 - age) % 2;
        return &heard[((half * 2 + version) * settings.channels + channel) * body.block()];
    }

    void process_head(const float* in, float* out) noexcept;
    void process_body() noexcept;
    double work_of(std::size_t unit) const noexcept;
    void do_unit(std::size_t unit) noexcept;
    std::size_t units() const noexcept {
        return settings.sources + settings.sources * settings.channels + settings.channels;
    }
    template <typename OfTail>
    void add_products(Stage& stage,
                      std::size_t source,
                      std::size_t channel,
                      const OfTail& filter_of) noexcept;
    void add_faded(const float* before, const float* after, float* out) const noexcept;

    Settings settings;
    Stage head, body;
    std::vector<TailPair> tails;
    std::vector<float> last_blocks;
    std::vector<float> gathered, heard, short_heard;
    std::size_t slice = 0;   // block of the period
    std::size_t period = 0;  // modulo 6
    std::size_t next_unit = 0;
    double work_done = 0.0, work = 0.0;
    bool is_fading = false, body_faded = false;
};

// A source whose tail stays counts for both sums, one whose tail changes for each with its own.
template <typename OfTail>
void TailConvolver::State::add_products(Stage& stage,
                                        std::size_t source,
                                        std::size_t channel,
                                        const OfTail& filter_of) noexcept {
    const TailPair& tail = tails[source];
    if (is_fading && tail.before != nullptr) {
        stage.add(source, channel, 0, filter_of(*tail.before));
    }
    if (tail.after != nullptr) {
        stage.add(source, channel, 1, filter_of(*tail.after));
    }
}

void TailConvolver::State::add_faded(const float* before,
                                     const float* after,
                                     float* out) const noexcept {
    const auto length = static_cast<float>(kPeriod * settings.block);
    for (std::size_t n = 0; n < settings.block; ++n) {
        const float along = static_cast<float>(slice * settings.block + n) / length;
        out[n] += before[n] + along * (after[n] - before[n]);
    }
}

void TailConvolver::State::process_head(const float* in, float* out) noexcept {
    const std::size_t block = settings.block;
    head.begin();
    for (std::size_t source = 0; source < settings.sources; ++source) {
        float* last = &last_blocks[source * block];
        head.take(source, last, in + source * block);
        std::copy(in + source * block, in + (source + 1) * block, last);
    }
    float* before = short_heard.data();
    float* after = before + block;
    for (std::size_t channel = 0; channel < settings.channels; ++channel) {
        for (std::size_t source = 0; source < settings.sources; ++source) {
            add_products(head, source, channel, [&](const Tail& tail) -> const PartitionedFilter& {
                return tail.head(channel);
            });
        }
        head.hear(channel, 1, after);
        if (is_fading) {
            head.hear(channel, 0, before);
        }
        add_faded(is_fading ? before : after, after, out + channel * block);
    }
}

double TailConvolver::State::work_of(std::size_t unit) const noexcept {
    const std::size_t products = settings.sources * settings.channels;
    const double versions = is_fading ? 2.0 : 1.0;
    if (unit < settings.sources) {
        return kTransformWork;
    }
    if (unit >= settings.sources + products) {
        return versions * kTransformWork;
    }
    const std::size_t pair = unit - settings.sources;
    const TailPair& tail = tails[pair / settings.channels];
    const std::size_t channel = pair % settings.channels;
    double parts =
        tail.after != nullptr ? static_cast<double>(tail.after->body(channel).parts()) : 0.0;
    if (is_fading && tail.before != nullptr) {
        parts += static_cast<double>(tail.before->body(channel).parts());
    }
    return parts;
}

void TailConvolver::State::do_unit(std::size_t unit) noexcept {
    const std::size_t products = settings.sources * settings.channels;
    if (unit < settings.sources) {
        body.take(unit, gathered_of(unit, 2), gathered_of(unit, 1));
    } else if (unit < settings.sources + products) {
        const std::size_t pair = unit - settings.sources;
        const std::size_t channel = pair % settings.channels;
        add_products(
            body,
            pair / settings.channels,
            channel,
            [&](const Tail& tail) -> const PartitionedFilter& { return tail.body(channel); });
    } else {
        const std::size_t channel = unit - settings.sources - products;
        body.hear(channel, 1, heard_of(channel, 1, 0));
        if (is_fading) {
            body.hear(channel, 0, heard_of(channel, 0, 0));
        }
    }
}

// As much of the period's work as brings it level with the time that has passed.
void TailConvolver::State::process_body() noexcept {
    const double due = work * static_cast<double>(slice + 1) / static_cast<double>(kPeriod);
    const bool is_last = slice + 1 == kPeriod;
    while (next_unit < units() && (is_last || work_done < due)) {
        do_unit(next_unit);
        work_done += work_of(next_unit);
        ++next_unit;
    }
}

TailConvolver::TailConvolver(const Settings& settings)
    : state_(std::make_unique<State>(settings)) {}
TailConvolver::~TailConvolver() = default;
TailConvolver::TailConvolver(TailConvolver&&) noexcept = default;
TailConvolver& TailConvolver::operator=(TailConvolver&&) noexcept = default;

bool TailConvolver::begins_period() const noexcept {
    return state_->slice == 0;
}

void TailConvolver::set_tails(std::span<const Tail* const> tails) noexcept {
    State& state = *state_;
    EARSHOT_ASSERT(begins_period() && tails.size() == state.tails.size());
    for (std::size_t source = 0; source < tails.size(); ++source) {
        state.tails[source].after = tails[source];
    }
}

void TailConvolver::process(const float* in, float* out) noexcept {
    State& state = *state_;
    const std::size_t block = state.settings.block;
    if (state.slice == 0) {
        state.body_faded = state.is_fading;  // what is heard was made in the period before
        state.is_fading = state.fades();
        state.body.begin();
        state.next_unit = 0;
        state.work_done = 0.0;
        state.work = 0.0;
        for (std::size_t unit = 0; unit < state.units(); ++unit) {
            state.work += state.work_of(unit);
        }
    }
    for (std::size_t source = 0; source < state.settings.sources; ++source) {
        std::copy(in + source * block,
                  in + (source + 1) * block,
                  state.gathered_of(source, 0) + state.slice * block);
    }
    state.process_head(in, out);
    for (std::size_t channel = 0; channel < state.settings.channels; ++channel) {
        const std::size_t begin = state.slice * block;
        const float* after = state.heard_of(channel, 1, 1) + begin;
        const float* before = state.body_faded ? state.heard_of(channel, 0, 1) + begin : after;
        state.add_faded(before, after, out + channel * block);
    }
    state.process_body();
    ++state.slice;
    if (state.slice == kPeriod) {
        state.slice = 0;
        state.period = (state.period + 1) % 6;
        for (TailPair& tail : state.tails) {
            tail.before = tail.after;
        }
    }
}

}  // namespace earshot::audio
