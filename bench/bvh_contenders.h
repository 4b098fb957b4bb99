// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/base/parallel.h"
#include "earshot/bvh/tree.h"
#include "earshot/geometry/mesh.h"

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace bench {

using earshot::Executor;
using earshot::geometry::MeshView;
using earshot::geometry::Ray;
using earshot::geometry::Segment;

/// A hierarchy that answers rays and keeps the answers, as a program that needs them does.
class Contender {
public:
    virtual ~Contender() = default;

    virtual std::string name() const = 0;
    /// From vertex positions to a structure that can be asked.
    virtual void build(const MeshView& mesh, Executor& executor) = 0;
    /// Moves to where the vertices are now; false if this contender has no refit.
    virtual bool refit(const MeshView& mesh, Executor& executor) = 0;
    virtual std::size_t bytes() const = 0;

    /// Called before the clock runs.
    virtual void prepare(const std::vector<Ray>& rays) = 0;
    virtual void prepare(const std::vector<Segment>& segments) = 0;
    /// How many of the rays or segments that prepare() was given hit something.
    virtual std::size_t closest(Executor& executor) = 0;
    virtual std::size_t any(Executor& executor) = 0;
    /// Of the answers; 0 where they are not earshot's bits.
    virtual std::uint64_t digest() const { return 0; }
};

/// earshot's: the binary tree, the wide tree ray by ray, in batches and with quantised leaves, and
/// the tree of the fastest build in batches.
std::vector<std::unique_ptr<Contender>> earshot_contenders(
    const earshot::bvh::BuildOptions& options);

/// Embree's: medium, robust, high, low (Morton), compact, and medium in packets of 16; none if the
/// library was not there at configure time. `simd` is an instruction set as override_simd_target()
/// takes it.
std::vector<std::unique_ptr<Contender>> embree_contenders(int threads,
                                                          const std::string& simd = "auto");

/// Rays per chunk of an executor.
inline constexpr std::size_t kGrain = 4096;

}  // namespace bench
