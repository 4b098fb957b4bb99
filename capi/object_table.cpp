// SPDX-License-Identifier: MIT
#include "earshot/capi/internal/object_table.h"

#include "earshot/capi/internal/failure.h"

#include <array>
#include <mutex>
#include <string>
#include <vector>

namespace earshot::capi {
namespace {

// A handle, from the highest bits down: kind (8), generation (32), slot (24).
constexpr unsigned kSlotBits = 24;
constexpr unsigned kGenerationBits = 32;
constexpr std::size_t kMaxSlots = std::size_t{1} << kSlotBits;

struct HandleParts {
    std::uint32_t kind = 0;
    std::uint32_t generation = 0;
    std::uint32_t slot = 0;
};

HandleParts parts_of(std::uint64_t handle) noexcept {
    return {.kind = static_cast<std::uint32_t>(handle >> (kSlotBits + kGenerationBits)),
            .generation = static_cast<std::uint32_t>(handle >> kSlotBits),
            .slot = static_cast<std::uint32_t>(handle & (kMaxSlots - 1))};
}

std::uint64_t handle_of(const HandleParts& parts) noexcept {
    return static_cast<std::uint64_t>(parts.kind) << (kSlotBits + kGenerationBits) |
           static_cast<std::uint64_t>(parts.generation) << kSlotBits | parts.slot;
}

constexpr std::array kKindNames = {"an object",
                                   "a scene",
                                   "a simulator",
                                   "a result",
                                   "a bvh",
                                   "a world",
                                   "contacts",
                                   "visible sets",
                                   "a sound",
                                   "messages",
                                   "a map",
                                   "a calibration",
                                   "a location",
                                   "a check",
                                   "a mending",
                                   "an engine"};
static_assert(kKindNames.size() == ES_KIND_ENGINE + 1);

struct Slot {
    std::shared_ptr<Object> object{};
    std::uint32_t generation = 1;  // of the object, or of the next one
};

/// All objects of the process.
class ObjectTable {
public:
    std::uint64_t add(std::shared_ptr<Object> object) {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) {
            if (slots_.size() == kMaxSlots) {
                throw Failure(ES_ERROR_OUT_OF_MEMORY,
                              "",
                              "there are 2^24 objects already",
                              "release those that are not needed with es_release()");
            }
            if (free_.capacity() <= slots_.size()) {
                free_.reserve(2 * slots_.size() + 16);  // so that remove() never allocates
            }
            slots_.emplace_back();
            free_.push_back(static_cast<std::uint32_t>(slots_.size() - 1));
        }
        const std::uint32_t slot = free_.back();
        free_.pop_back();
        slots_[slot].object = std::move(object);
        ++count_;
        return handle_of({.kind = static_cast<std::uint32_t>(slots_[slot].object->kind()),
                          .generation = slots_[slot].generation,
                          .slot = slot});
    }

    /// The object, or null.
    std::shared_ptr<Object> find(std::uint64_t handle) const {
        const std::lock_guard lock(mutex_);
        const HandleParts parts = parts_of(handle);
        return holds(parts) ? slots_[parts.slot].object : nullptr;
    }

    /// Takes the object out and returns it, or null.
    std::shared_ptr<Object> remove(std::uint64_t handle) {
        const std::lock_guard lock(mutex_);
        const HandleParts parts = parts_of(handle);
        if (!holds(parts)) {
            return nullptr;
        }
        Slot& slot = slots_[parts.slot];
        std::shared_ptr<Object> object = std::move(slot.object);
        slot.object.reset();
        --count_;
        ++slot.generation;
        // A slot whose generations are used up is not used again: no old handle comes to life.
        if (slot.generation != 0) {
            free_.push_back(parts.slot);
        }
        return object;
    }

    /// Whether the handle was that of an object once.
    bool was_released(std::uint64_t handle) const {
        const std::lock_guard lock(mutex_);
        const HandleParts parts = parts_of(handle);
        return parts.kind > 0 && parts.kind < kKindNames.size() && parts.slot < slots_.size() &&
               parts.generation != 0 &&
               (slots_[parts.slot].generation == 0 ||
                parts.generation < slots_[parts.slot].generation);
    }

    std::size_t count() const {
        const std::lock_guard lock(mutex_);
        return count_;
    }

private:
    bool holds(const HandleParts& parts) const {
        return parts.slot < slots_.size() && slots_[parts.slot].object != nullptr &&
               slots_[parts.slot].generation == parts.generation &&
               static_cast<std::uint32_t>(slots_[parts.slot].object->kind()) == parts.kind;
    }

    mutable std::mutex mutex_;
    std::vector<Slot> slots_;
    std::vector<std::uint32_t> free_;
    std::size_t count_ = 0;
};

// Never destroyed: threads may still hold handles while the process ends.
ObjectTable& table() {
    static ObjectTable& objects = *new ObjectTable;
    return objects;
}

[[noreturn]] void fail_handle(std::uint64_t handle, es_kind kind, const char* argument) {
    const std::string wanted = kKindNames[static_cast<std::size_t>(kind)];
    if (handle == 0) {
        throw Failure(
            ES_ERROR_HANDLE, argument, "is 0, which is no handle", "give a handle of " + wanted);
    }
    if (table().was_released(handle)) {
        throw Failure(ES_ERROR_HANDLE,
                      argument,
                      std::string("is a handle of ") + kKindNames[parts_of(handle).kind] +
                          " that was released",
                      "give a handle of " + wanted + " that exists");
    }
    throw Failure(ES_ERROR_HANDLE,
                  argument,
                  "is no handle that this library gave",
                  "give a handle of " + wanted);
}

}  // namespace

bool Object::begin_read() noexcept {
    int users = users_.load(std::memory_order_relaxed);
    do {
        if (users == kChanging) {
            return false;
        }
    } while (!users_.compare_exchange_weak(users, users + 1, std::memory_order_acquire));
    return true;
}

bool Object::begin_change() noexcept {
    int nobody = 0;
    return users_.compare_exchange_strong(nobody, kChanging, std::memory_order_acquire);
}

std::uint64_t publish(std::shared_ptr<Object> object) {
    return table().add(std::move(object));
}

std::shared_ptr<Object> object_of(std::uint64_t handle, es_kind kind, const char* argument) {
    std::shared_ptr<Object> object = table().find(handle);
    if (object == nullptr) {
        fail_handle(handle, kind, argument);
    }
    if (object->kind() != kind) {
        throw Failure(
            ES_ERROR_HANDLE,
            argument,
            std::string("is a handle of ") + kKindNames[static_cast<std::size_t>(object->kind())],
            std::string("give a handle of ") + kKindNames[static_cast<std::size_t>(kind)]);
    }
    return object;
}

void fail_busy(es_kind kind, const char* argument) {
    throw Failure(ES_ERROR_BUSY,
                  argument,
                  std::string("is a handle of ") + kKindNames[static_cast<std::size_t>(kind)] +
                      " that another call is using",
                  "wait for that call, or give each thread an object of its own");
}

}  // namespace earshot::capi

es_status es_release(uint64_t handle) {
    return earshot::capi::call("es_release", [&] {
        // The object ends here, or with the call that uses it.
        if (handle != 0 && earshot::capi::table().remove(handle) == nullptr) {
            earshot::capi::fail_handle(handle, ES_KIND_NONE, "handle");
        }
    });
}

int32_t es_kind_of(uint64_t handle) {
    const auto object = earshot::capi::table().find(handle);
    return object == nullptr ? ES_KIND_NONE : object->kind();
}

size_t es_object_count(void) {
    return earshot::capi::table().count();
}
