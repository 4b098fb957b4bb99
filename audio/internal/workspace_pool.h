// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace earshot::audio {

/// Memory that one thread at a time works in and that is kept for the next: as many workspaces as
/// threads have been at work at once. What a workspace holds on loan is left over from others.
template <typename Workspace>
class WorkspacePool {
public:
    /// Calls work(workspace).
    template <typename Work>
    void with(Work&& work) {
        std::unique_ptr<Workspace> workspace = take();
        work(*workspace);
        const std::lock_guard lock(mutex_);
        free_.push_back(std::move(workspace));
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

    std::mutex mutex_;
    std::vector<std::unique_ptr<Workspace>> free_;
};

}  // namespace earshot::audio
