// SPDX-License-Identifier: MIT
#include "earshot/visibility/internal/mutation_store.h"

namespace earshot::visibility {

void MutationStore::add(const Candidate& candidate) {
    if (size_ == most_) {
        while (by_uses_.back().empty()) {
            by_uses_.pop_back();
        }
        by_uses_.back().pop_front();
        --size_;
    }
    if (by_uses_.empty()) {
        by_uses_.emplace_back();
    }
    by_uses_[0].push_back(candidate);
    least_ = 0;
    ++size_;
}

std::optional<Candidate> MutationStore::take() {
    while (least_ < by_uses_.size() && by_uses_[least_].empty()) {
        ++least_;
    }
    if (least_ == by_uses_.size()) {
        return std::nullopt;
    }
    const Candidate candidate = by_uses_[least_].front();
    by_uses_[least_].pop_front();
    if (least_ + 1 == by_uses_.size()) {
        by_uses_.emplace_back();
    }
    by_uses_[least_ + 1].push_back(candidate);
    return candidate;
}

}  // namespace earshot::visibility
