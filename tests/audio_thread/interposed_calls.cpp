// SPDX-License-Identifier: MIT
#include "interposed_calls.h"

#include <cerrno>
#include <cstddef>
#include <dlfcn.h>
#include <pthread.h>
#include <utility>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define EARSHOT_HAS_SANITIZER
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define EARSHOT_HAS_SANITIZER
#endif
#endif

namespace earshot::test {
namespace {

thread_local bool is_watched = false;
thread_local WatchedCalls watched_calls;

}  // namespace

CallWatch::CallWatch() noexcept {
    is_watched = true;
}

CallWatch::~CallWatch() {
    is_watched = false;
}

WatchedCalls CallWatch::calls() noexcept {
    return watched_calls;
}

bool CallWatch::is_available() noexcept {
#ifdef EARSHOT_HAS_SANITIZER
    return false;
#else
    return true;
#endif
}

#ifndef EARSHOT_HAS_SANITIZER

namespace {

void count_call(const char* name) noexcept {
    if (is_watched && watched_calls.count++ == 0) {
        watched_calls.first = name;
    }
}

// The C library's function of that name. dlsym() itself allocates and locks, so it is asked before
// anybody is watched: at the first call, which start-up makes.
template <typename... Arguments>
int call_next(const char* name, int (*&next)(Arguments...), Arguments... arguments) noexcept {
    count_call(name);
    if (next == nullptr) {
        next = reinterpret_cast<int (*)(Arguments...)>(dlsym(RTLD_NEXT, name));
    }
    return next == nullptr ? EINVAL : next(arguments...);
}

}  // namespace

// The allocator of glibc under its other names.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) {
    count_call("malloc");
    return __libc_malloc(size);
}

void* calloc(std::size_t count, std::size_t size) {
    count_call("calloc");
    return __libc_calloc(count, size);
}

void* realloc(void* block, std::size_t size) {
    count_call("realloc");
    return __libc_realloc(block, size);
}

void* aligned_alloc(std::size_t alignment, std::size_t size) {
    count_call("aligned_alloc");
    return __libc_memalign(alignment, size);
}

void* memalign(std::size_t alignment, std::size_t size) {
    count_call("memalign");
    return __libc_memalign(alignment, size);
}

int posix_memalign(void** block, std::size_t alignment, std::size_t size) {
    count_call("posix_memalign");
    *block = __libc_memalign(alignment, size);
    return *block == nullptr ? ENOMEM : 0;
}

void free(void* block) {
    count_call("free");
    __libc_free(block);
}

int pthread_mutex_lock(pthread_mutex_t* mutex) {
    static int (*next)(pthread_mutex_t*) = nullptr;
    return call_next("pthread_mutex_lock", next, mutex);
}

int pthread_mutex_trylock(pthread_mutex_t* mutex) {
    static int (*next)(pthread_mutex_t*) = nullptr;
    return call_next("pthread_mutex_trylock", next, mutex);
}

int pthread_rwlock_rdlock(pthread_rwlock_t* lock) {
    static int (*next)(pthread_rwlock_t*) = nullptr;
    return call_next("pthread_rwlock_rdlock", next, lock);
}

int pthread_rwlock_wrlock(pthread_rwlock_t* lock) {
    static int (*next)(pthread_rwlock_t*) = nullptr;
    return call_next("pthread_rwlock_wrlock", next, lock);
}

int pthread_spin_lock(pthread_spinlock_t* lock) {
    static int (*next)(pthread_spinlock_t*) = nullptr;
    return call_next("pthread_spin_lock", next, lock);
}
}

#endif

}  // namespace earshot::test
