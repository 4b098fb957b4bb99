// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/capi/earshot.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <utility>

namespace earshot::capi {

/// What a handle stands for.
class Object {
public:
    explicit Object(es_kind kind) noexcept : kind_(kind) {}
    virtual ~Object() = default;
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;

    es_kind kind() const noexcept { return kind_; }

    // Users are either any number of readers or one that changes it. Nobody waits: who cannot be a
    // user at once is told.

    bool begin_read() noexcept;
    bool begin_change() noexcept;
    void end_read() noexcept { users_.fetch_sub(1, std::memory_order_release); }
    void end_change() noexcept { users_.store(0, std::memory_order_release); }

private:
    static constexpr int kChanging = -1;

    es_kind kind_;
    std::atomic<int> users_{0};
};

/// An object of a kind: `struct Scene : ObjectOf<ES_KIND_SCENE>`.
template <es_kind Kind>
class ObjectOf : public Object {
public:
    static constexpr es_kind kKind = Kind;
    ObjectOf() noexcept : Object(Kind) {}
};

/// Gives an object a handle. Throws Failure if there are too many.
std::uint64_t publish(std::shared_ptr<Object> object);

/// The object of a handle. Throws Failure, which names `argument`, if it is none, or of another
/// kind.
std::shared_ptr<Object> object_of(std::uint64_t handle, es_kind kind, const char* argument);

/// A failure that says that another call uses the object.
[[noreturn]] void fail_busy(es_kind kind, const char* argument);

/// An object in use: kept alive, and kept from being changed by others.
template <typename T>
class Reading {
public:
    Reading(std::uint64_t handle, const char* argument)
        : object_(std::static_pointer_cast<T>(object_of(handle, T::kKind, argument))) {
        if (!object_->begin_read()) {
            fail_busy(T::kKind, argument);
        }
    }
    ~Reading() { object_->end_read(); }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

    const T& operator*() const noexcept { return *object_; }
    const T* operator->() const noexcept { return object_.get(); }

private:
    std::shared_ptr<T> object_;
};

/// An object that is changed, and that nobody else uses meanwhile.
template <typename T>
class Changing {
public:
    Changing(std::uint64_t handle, const char* argument)
        : object_(std::static_pointer_cast<T>(object_of(handle, T::kKind, argument))) {
        if (!object_->begin_change()) {
            fail_busy(T::kKind, argument);
        }
    }
    ~Changing() { object_->end_change(); }
    Changing(const Changing&) = delete;
    Changing& operator=(const Changing&) = delete;

    T& operator*() const noexcept { return *object_; }
    T* operator->() const noexcept { return object_.get(); }

private:
    std::shared_ptr<T> object_;
};

}  // namespace earshot::capi
