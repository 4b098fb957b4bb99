// SPDX-License-Identifier: MIT
#include "system_call_filter.h"

#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstddef>
#include <linux/filter.h>
#include <linux/seccomp.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

namespace earshot::test {
namespace {

std::atomic<int> refused_count{0};
std::atomic<long> first_refused{-1};

// The kernel sends SIGSYS in place of a call that is refused, which then returns what the context
// says.
void record(int /*signal*/, siginfo_t* information, void* context) {
    static_cast<ucontext_t*>(context)->uc_mcontext.gregs[REG_RAX] = -ENOSYS;
    long none = -1;
    first_refused.compare_exchange_strong(none, information->si_syscall);
    refused_count.fetch_add(1);
}

}  // namespace

bool refuse_system_calls() noexcept {
    struct sigaction action = {};
    action.sa_sigaction = record;
    action.sa_flags = SA_SIGINFO;
    if (sigaction(SIGSYS, &action, nullptr) != 0) {
        return false;
    }
    constexpr auto kNumber = static_cast<unsigned>(offsetof(seccomp_data, nr));
    std::array<sock_filter, 5> program = {
        sock_filter BPF_STMT(BPF_LD | BPF_W | BPF_ABS, kNumber),
        sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_exit, 2, 0),
        sock_filter BPF_JUMP(BPF_JMP | BPF_JEQ | BPF_K, SYS_rt_sigreturn, 1, 0),
        sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_TRAP),
        sock_filter BPF_STMT(BPF_RET | BPF_K, SECCOMP_RET_ALLOW),
    };
    const sock_fprog filter = {.len = program.size(), .filter = program.data()};
    return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
           prctl(PR_SET_SECCOMP, SECCOMP_MODE_FILTER, &filter) == 0;
}

RefusedCalls refused_calls() noexcept {
    return {refused_count.load(), first_refused.load()};
}

void clear_refused_calls() noexcept {
    refused_count = 0;
    first_refused = -1;
}

void end_thread() noexcept {
    for (;;) {
        syscall(SYS_exit, 0);
    }
}

}  // namespace earshot::test
