// SPDX-License-Identifier: MIT
#include "earshot/base/digest.h"
#include "earshot/bvh/ray.h"
#include "earshot/bvh/wide_batch.h"
#include "earshot/bvh/wide_ray.h"

#include "bvh_contenders.h"
#include <algorithm>
#include <optional>
#include <span>

namespace bench {
namespace {

using earshot::bvh::BuildOptions;
using earshot::bvh::Tree;
using earshot::bvh::WideTree;
using earshot::geometry::Hit;

class Earshot : public Contender {
public:
    explicit Earshot(const BuildOptions& options) : options_(options) {}

    void prepare(const std::vector<Ray>& rays) override {
        rays_ = rays;
        hits_.resize(rays.size());
    }
    void prepare(const std::vector<Segment>& segments) override {
        segments_ = segments;
        blocked_.resize(segments.size());
    }
    std::size_t closest(Executor& executor) override {
        find_closest(executor);
        return static_cast<std::size_t>(std::count_if(
            hits_.begin(), hits_.end(), [](const auto& hit) { return hit.has_value(); }));
    }
    std::size_t any(Executor& executor) override {
        find_any(executor);
        return static_cast<std::size_t>(std::count(blocked_.begin(), blocked_.end(), 1));
    }
    std::uint64_t digest() const override {
        earshot::Digest digest;
        for (const auto& hit : hits_) {
            digest.add(hit ? hit->t : -1.0);
            digest.add(hit ? hit->triangle : 0U);
        }
        digest.add_bytes(std::as_bytes(std::span(blocked_)));
        return digest.value();
    }

protected:
    virtual void find_closest(Executor& executor) = 0;
    virtual void find_any(Executor& executor) = 0;

    BuildOptions options_;
    MeshView mesh_;
    std::span<const Ray> rays_;
    std::span<const Segment> segments_;
    std::vector<std::optional<Hit>> hits_;
    std::vector<std::uint8_t> blocked_;
};

class Binary : public Earshot {
public:
    using Earshot::Earshot;
    std::string name() const override { return "earshot binary"; }
    void build(const MeshView& mesh, Executor& executor) override {
        mesh_ = mesh;
        tree_ = Tree::build(earshot::bvh::triangle_boxes(mesh, executor), options_, executor);
    }
    bool refit(const MeshView& mesh, Executor& executor) override {
        mesh_ = mesh;
        tree_.refit(earshot::bvh::triangle_boxes(mesh, executor), executor);
        return true;
    }
    std::size_t bytes() const override {
        return tree_.nodes().size_bytes() + tree_.primitives().size_bytes();
    }

protected:
    void find_closest(Executor& executor) override {
        executor.for_each(rays_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                hits_[i] = closest_hit(tree_, mesh_, rays_[i]);
            }
        });
    }
    void find_any(Executor& executor) override {
        executor.for_each(segments_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                blocked_[i] = occluded(tree_, mesh_, segments_[i]) ? 1 : 0;
            }
        });
    }

private:
    Tree tree_;
};

class Wide : public Earshot {
public:
    using Earshot::Earshot;
    std::string name() const override { return "earshot wide"; }
    void build(const MeshView& mesh, Executor& executor) override {
        mesh_ = mesh;
        tree_ = WideTree::build(
            Tree::build(earshot::bvh::triangle_boxes(mesh, executor), options_, executor),
            mesh,
            executor,
            leaves());
    }
    bool refit(const MeshView& mesh, Executor& executor) override {
        mesh_ = mesh;
        tree_.refit(mesh, executor);
        return true;
    }
    std::size_t bytes() const override { return tree_.bytes(); }

protected:
    void find_closest(Executor& executor) override {
        executor.for_each(rays_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                hits_[i] = closest_hit(tree_, mesh_, rays_[i]);
            }
        });
    }
    void find_any(Executor& executor) override {
        executor.for_each(segments_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                blocked_[i] = occluded(tree_, mesh_, segments_[i]) ? 1 : 0;
            }
        });
    }

    virtual earshot::bvh::LeafEncoding leaves() const { return earshot::bvh::LeafEncoding::single; }

    WideTree tree_;
};

class WideBatch : public Wide {
public:
    using Wide::Wide;
    std::string name() const override { return "earshot batch"; }

protected:
    void find_closest(Executor& executor) override {
        closest_hits(tree_, mesh_, rays_, hits_, executor);
    }
    void find_any(Executor& executor) override {
        occluded(tree_, mesh_, segments_, blocked_, executor);
    }
};

/// The fastest build: leaves as large as a wide tree's.
class Fast : public WideBatch {
public:
    Fast()
        : WideBatch({.builder = earshot::bvh::Builder::fast,
                     .max_leaf_size = static_cast<int>(earshot::bvh::kMaxLeafTriangles)}) {}
    std::string name() const override { return "earshot fast"; }
};

class Quantised : public WideBatch {
public:
    using WideBatch::WideBatch;
    std::string name() const override { return "earshot quantised"; }

protected:
    earshot::bvh::LeafEncoding leaves() const override {
        return earshot::bvh::LeafEncoding::quantised;
    }
};

}  // namespace

std::vector<std::unique_ptr<Contender>> earshot_contenders(const BuildOptions& options) {
    std::vector<std::unique_ptr<Contender>> contenders;
    contenders.push_back(std::make_unique<Binary>(options));
    contenders.push_back(std::make_unique<Wide>(options));
    contenders.push_back(std::make_unique<WideBatch>(options));
    contenders.push_back(std::make_unique<Quantised>(options));
    contenders.push_back(std::make_unique<Fast>());
    return contenders;
}

}  // namespace bench
