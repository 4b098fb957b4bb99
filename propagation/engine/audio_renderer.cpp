// SPDX-License-Identifier: MIT
#include "earshot/propagation/engine/internal/audio_renderer.h"

#include "earshot/audio/spatial.h"
#include "earshot/propagation/engine/internal/packed_rotation.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace earshot::propagation {

namespace {

// Of a way to a snapshot that came late: 20 ms at 48 kHz, over which a wrong guess of its delays is
// mended without being heard.
constexpr double kCatchUp = 0.02;  // seconds

std::int64_t whole_blocks(double seconds, double sample_rate, std::size_t block) {
    const double blocks = std::ceil(seconds * sample_rate / static_cast<double>(block) - 1e-9);
    return static_cast<std::int64_t>(blocks) * static_cast<std::int64_t>(block);
}

}  // namespace

AudioRenderer::AudioRenderer(const EngineOptions& options,
                             const RenderSize& size,
                             const audio::FilterBasis& basis,
                             double speed_of_sound,
                             SnapshotExchange& exchange)
    : block_(options.block),
      motion_delay_(whole_blocks(options.motion_delay, options.sample_rate, options.block)),
      catch_up_(whole_blocks(kCatchUp, options.sample_rate, options.block)),
      any_frame_count_(options.any_frame_count),
      channels_(options.channels),
      size_(size),
      exchange_(exchange),
      mixer_(options.block, speed_of_sound / options.sample_rate),
      rotation_(options.channels == Channels::mono ? 0 : options.ambisonic_order),
      rotations_(size.listeners),
      in_(size.sources * options.block, 0.0F),
      out_(size.listeners * size.outputs * options.block, 0.0F),
      field_(size.harmonics * options.block, 0.0F),
      turned_(size.harmonics * options.block, 0.0F),
      load_(static_cast<double>(options.block) / options.sample_rate) {
    for (std::size_t source = 0; source < size.sources; ++source) {
        lines_.emplace_back(
            basis,
            audio::SourceLines::Settings{.block = block_,
                                         .max_delay = static_cast<std::size_t>(
                                             std::ceil(options.max_delay * options.sample_rate))});
    }
    std::size_t ear_parts = 0;
    if (channels_ == Channels::binaural) {
        const audio::HrirSet set =
            audio::resampled(audio::farthest_measurements(options.hrir_set), options.sample_rate);
        const audio::HarmonicHrirs ears =
            audio::harmonic_hrirs(audio::HrirInterpolator(set), options.ambisonic_order);
        ear_latency_ = ears.latency;
        for (std::size_t channel = 0; channel < size.harmonics; ++channel) {
            for (std::size_t ear = 0; ear < 2; ++ear) {
                ear_parts = std::max(
                    ear_parts, ear_filters_.emplace_back(ears.ears[ear][channel], block_).parts());
            }
        }
    }
    for (std::size_t index = 0; index < size.listeners; ++index) {
        Listener& listener = listeners_.emplace_back(
            Listener{.voices = ListenerVoices(options.max_paths, basis.filters(), size.harmonics),
                     .rotation_from = std::vector<float>(rotation_.coefficients()),
                     .rotation_to = std::vector<float>(rotation_.coefficients())});
        if (size.tail_length > 0) {
            listener.tail.emplace(audio::TailConvolver::Settings{.sources = size.sources,
                                                                 .channels = size.tail_channels,
                                                                 .block = block_,
                                                                 .max_length = size.tail_length});
        }
        if (channels_ == Channels::binaural) {
            listener.ears.emplace(audio::MatrixConvolver::Settings{
                .inputs = size.harmonics, .outputs = 2, .block = block_, .max_parts = ear_parts});
        }
    }
}

AudioRenderer::~AudioRenderer() {
    std::vector<Snapshot*> held(pending_.begin(),
                                pending_.begin() + static_cast<std::ptrdiff_t>(pending_count_));
    for (Snapshot* snapshot : {current_, tails_, last_tails_}) {
        if (snapshot != nullptr && std::find(held.begin(), held.end(), snapshot) == held.end()) {
            held.push_back(snapshot);
        }
    }
    for (Snapshot* snapshot : held) {
        delete snapshot;
    }
}

std::size_t AudioRenderer::latency() const noexcept {
    return audio::kArrivalLatency + ear_latency_ + (any_frame_count_ ? block_ : 0);
}

void AudioRenderer::copy_in(const float* const* inputs,
                            std::size_t from,
                            std::size_t to,
                            std::size_t count) noexcept {
    for (std::size_t source = 0; source < size_.sources; ++source) {
        float* in = &in_[source * block_ + to];
        if (inputs == nullptr || inputs[source] == nullptr) {
            std::fill_n(in, count, 0.0F);
        } else {
            std::copy_n(inputs[source] + from, count, in);
        }
    }
}

void AudioRenderer::copy_out(float* const* outputs,
                             std::size_t from,
                             std::size_t to,
                             std::size_t count) const noexcept {
    for (std::size_t channel = 0; channel < size_.listeners * size_.outputs; ++channel) {
        if (outputs[channel] != nullptr) {
            std::copy_n(&out_[channel * block_ + from], count, outputs[channel] + to);
        }
    }
}

void AudioRenderer::render(const float* const* inputs,
                           float* const* outputs,
                           std::size_t frames) noexcept {
    if (!any_frame_count_ && frames % block_ != 0) {
        for (std::size_t channel = 0; channel < size_.listeners * size_.outputs; ++channel) {
            if (outputs[channel] != nullptr) {
                std::fill_n(outputs[channel], frames, 0.0F);
            }
        }
        refused_calls_.store(refused_calls_.load(std::memory_order_relaxed) + 1,
                             std::memory_order_relaxed);
        return;
    }
    for (std::size_t done = 0; done < frames;) {
        const std::size_t count = std::min(frames - done, block_ - filled_);
        copy_in(inputs, done, filled_, count);
        if (any_frame_count_) {
            copy_out(outputs, filled_, done, count);  // of the block before
        }
        filled_ += count;
        if (filled_ == block_) {
            render_block();
            filled_ = 0;
            if (!any_frame_count_) {
                copy_out(outputs, 0, done, count);
            }
        }
        done += count;
    }
}

void AudioRenderer::render_block() noexcept {
    const std::uint64_t begin = LoadHistogram::ticks();
    for (std::size_t source = 0; source < size_.sources; ++source) {
        lines_[source].push(&in_[source * block_]);
    }
    take_snapshots();
    for (std::size_t index = 0; index < size_.listeners; ++index) {
        render_listener(index);
    }
    now_ += static_cast<std::int64_t>(block_);
    frames_.store(static_cast<std::uint64_t>(now_), std::memory_order_release);
    load_.count(LoadHistogram::ticks() - begin);
}

void AudioRenderer::take_snapshots() noexcept {
    while (pending_count_ < kMaxPending) {
        Snapshot* snapshot = exchange_.take();
        if (snapshot == nullptr) {
            break;
        }
        pending_[pending_count_] = snapshot;
        ++pending_count_;
    }
    if (now_ >= segment_.end || (holds_ > 0 && pending_count_ > 0)) {
        begin_segment();
    }
    change_tails();
}

// The next way: to the first snapshot whose time is yet to come, or to the newest.
void AudioRenderer::begin_segment() noexcept {
    while (pending_count_ > 1 && pending_[0]->frame + motion_delay_ <= now_) {
        Snapshot* skipped = pending_[0];
        std::copy(pending_.begin() + 1, pending_.end(), pending_.begin());
        --pending_count_;
        exchange_.give_back(skipped);
    }
    if (pending_count_ > 0) {
        Snapshot* next = pending_[0];
        std::copy(pending_.begin() + 1, pending_.end(), pending_.begin());
        --pending_count_;
        begin_snapshot(next);
        return;
    }
    // None has come: on at the same rates for as long as the last one lasted, then to rest.
    const std::int64_t length =
        std::max(segment_.end - segment_.begin, static_cast<std::int64_t>(block_));
    segment_ = {.begin = now_, .end = now_ + length};
    for (Listener& listener : listeners_) {
        listener.voices.hold(segment_, holds_ > 0);
    }
    ++holds_;
}

void AudioRenderer::begin_snapshot(Snapshot* snapshot) noexcept {
    const std::int64_t meant = snapshot->frame + motion_delay_;
    std::int64_t end = meant;
    if (current_ == nullptr) {
        end = now_ + static_cast<std::int64_t>(block_);  // nothing has sounded yet
    } else if (meant <= now_) {
        end = now_ + catch_up_;
        late_snapshots_.store(late_snapshots_.load(std::memory_order_relaxed) + 1,
                              std::memory_order_relaxed);
    }
    segment_ = {.begin = now_, .end = end};
    // Of a snapshot that is heard before its time nothing is continued.
    const double late = current_ == nullptr ? 0.0 : static_cast<double>(end - meant);
    for (std::size_t index = 0; index < listeners_.size(); ++index) {
        listeners_[index].voices.begin(snapshot->listeners[index], segment_, late);
    }
    holds_ = 0;
    snapshot->was_heard = true;
    release(std::exchange(current_, snapshot));
}

// A snapshot's tails sound from the begin of a period on, and for that period fade out later.
void AudioRenderer::change_tails() noexcept {
    if (size_.tail_length == 0 || !listeners_.front().tail->begins_period()) {
        return;
    }
    Snapshot* silent = last_tails_;
    last_tails_ = tails_;
    tails_ = current_;
    if (silent != last_tails_) {
        release(silent);
    }
    if (tails_ == nullptr || tails_ == last_tails_) {
        return;
    }
    for (std::size_t index = 0; index < listeners_.size(); ++index) {
        listeners_[index].tail->set_tails(tails_->listeners[index].tail_pointers);
    }
}

// Gives a snapshot back unless something of it still sounds.
void AudioRenderer::release(Snapshot* snapshot) noexcept {
    if (snapshot != nullptr && snapshot != current_ && snapshot != tails_ &&
        snapshot != last_tails_) {
        exchange_.give_back(snapshot);
    }
}

void AudioRenderer::turn(Listener& listener, std::uint64_t rotation) noexcept {
    std::swap(listener.rotation_from, listener.rotation_to);
    if (rotation != listener.rotation || listener.is_new) {
        rotation_.matrix(unpack_rotation(rotation), listener.rotation_to);
        if (listener.is_new) {
            listener.rotation_from = listener.rotation_to;
            listener.is_new = false;
        }
        listener.rotation = rotation;
        listener.is_turning = true;
    } else if (listener.is_turning) {
        listener.rotation_to = listener.rotation_from;
        listener.is_turning = false;
    }
}

void AudioRenderer::render_listener(std::size_t index) noexcept {
    Listener& listener = listeners_[index];
    std::fill(field_.begin(), field_.end(), 0.0F);
    listener.voices.add(now_, lines_, mixer_, field_.data());
    if (listener.tail) {
        listener.tail->process(in_.data(), field_.data());
    }
    turn(listener, rotations_[index].load(std::memory_order_relaxed));
    float* out = &out_[index * size_.outputs * block_];
    if (channels_ == Channels::binaural) {
        rotation_.apply(
            listener.rotation_from, listener.rotation_to, block_, field_.data(), turned_.data());
        listener.ears->process(ear_filters_.data(), turned_.data(), out);
    } else {
        rotation_.apply(listener.rotation_from, listener.rotation_to, block_, field_.data(), out);
    }
}

}  // namespace earshot::propagation
