// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace earshot::audio {

/// Memory that one thread at a time works in and that is kept for the next: as many workspaces as
/// have been on loan at once. What a workspace holds on loan is left over from others.
template <typename Workspace>
class WorkspacePool {
public:
    /// A workspace that goes back to its pool, which must outlive it.
    class Loan {
    public:
        Loan(WorkspacePool& pool, std::unique_ptr<Workspace> workspace)
            : pool_(pool), workspace_(std::move(workspace)) {}
        ~Loan() { pool_.give_back(std::move(workspace_)); }
        Loan(const Loan&) = delete;
        Loan& operator=(const Loan&) = delete;

        Workspace& operator*() const noexcept { return *workspace_; }
        Workspace* operator->() const noexcept { return workspace_.get(); }

    private:
        WorkspacePool& pool_;
        std::unique_ptr<Workspace> workspace_;
    };

    Loan borrow() { return Loan(*this, take()); }

    /// Calls work(workspace).
    template <typename Work>
    void with(Work&& work) {
        const Loan loan = borrow();
        work(*loan);
    }

private:
    std::unique_ptr<Workspace> take() {
        const std::lock_guard lock(mutex_);
        if (free_.empty()) {
            return std::make_unique<Workspace>();
        }
        std::unique_ptr<Workspace> workspace = std::move(free_.back());
        free_.pop_back();
        return workspace;
    }

    void give_back(std::unique_ptr<Workspace> workspace) {
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(workspace));
    }

    std::mutex mutex_;
    std::vector<std::unique_ptr<Workspace>> free_;
};

}  // namespace earshot::audio
