// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <memory>
#include <new>
#include <type_traits>

namespace earshot {

/// Asks the system to back memory that nobody has touched yet with large pages, where it can. The
/// first touches of small pages otherwise cost as much as a sixth of the time that building a
/// hierarchy takes. Best called on large arrays right after allocation; has no effect on contents.
void ask_for_large_pages(void* memory, std::size_t bytes) noexcept;

/// An array whose elements begin uninitialised and on a cache line, in large pages if it is large.
template <class T>
class UntouchedArray {
    static_assert(std::is_trivial_v<T>);

public:
    explicit UntouchedArray(std::size_t count)
        : elements_(static_cast<T*>(::operator new(count * sizeof(T), kLine))) {
        ask_for_large_pages(elements_.get(), count * sizeof(T));
    }

    T* data() const noexcept { return elements_.get(); }

private:
    static constexpr std::align_val_t kLine{64};
    struct Free {
        void operator()(T* elements) const noexcept { ::operator delete(elements, kLine); }
    };

    std::unique_ptr<T, Free> elements_;
};

}  // namespace earshot
