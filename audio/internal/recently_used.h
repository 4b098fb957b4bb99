// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

namespace earshot::audio {

/// Objects that are costly to make, each from a key, of which those used last are kept: as many as
/// fit into a number of bytes, and all that are on loan. `Object` is made by Object(key) and has
/// key() and bytes().
template <typename Object>
class RecentlyUsed {
    struct Entry {
        std::unique_ptr<const Object> object;
        std::size_t loans = 0;
    };

public:
    explicit RecentlyUsed(std::size_t max_bytes) : max_bytes_(max_bytes) {}

    /// An object that stays where it is as long as the loan. The cache must outlive it.
    class Loan {
    public:
        Loan(RecentlyUsed& cache, Entry& entry) : cache_(cache), entry_(entry) {}
        ~Loan() { cache_.give_back(entry_); }
        Loan(const Loan&) = delete;
        Loan& operator=(const Loan&) = delete;

        const Object& operator*() const noexcept { return *entry_.object; }
        const Object* operator->() const noexcept { return entry_.object.get(); }

    private:
        RecentlyUsed& cache_;
        Entry& entry_;
    };

    template <typename Key>
    Loan borrow(const Key& key) {
        const std::lock_guard lock(mutex_);
        auto found = std::find_if(entries_.begin(), entries_.end(), [&](const auto& entry) {
            return entry->object->key() == key;
        });
        if (found == entries_.end()) {
            // Made under the lock: other threads mostly want the same object.
            auto object = std::make_unique<const Object>(key);
            bytes_ += object->bytes();
            entries_.push_back(std::make_unique<Entry>());
            entries_.back()->object = std::move(object);
            found = entries_.end() - 1;
        }
        std::rotate(found, found + 1, entries_.end());
        Entry& entry = *entries_.back();
        ++entry.loans;
        remove_oldest();
        return Loan(*this, entry);
    }

    /// How many objects are kept.
    std::size_t size() const {
        const std::lock_guard lock(mutex_);
        return entries_.size();
    }

private:
    void give_back(Entry& entry) {
        const std::lock_guard lock(mutex_);
        --entry.loans;
    }

    /// What is not on loan leaves, the least recently used first, until the rest fits.
    void remove_oldest() {
        for (std::size_t i = 0; bytes_ > max_bytes_ && i < entries_.size();) {
            if (entries_[i]->loans > 0) {
                ++i;
                continue;
            }
            bytes_ -= entries_[i]->object->bytes();
            entries_.erase(entries_.begin() + static_cast<std::ptrdiff_t>(i));
        }
    }

    std::size_t max_bytes_;
    std::size_t bytes_ = 0;
    mutable std::mutex mutex_;
    std::vector<std::unique_ptr<Entry>> entries_;  // the most recently used last
};

}  // namespace earshot::audio
