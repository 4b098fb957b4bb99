// SPDX-License-Identifier: MIT
#pragma once

#include "earshot/propagation/map_limit.h"

#include <string>
#include <vector>

namespace earshot::cli {

/// What came of `earshot map`, for a person or a program.
class MapSummary {
public:
    /// Both arguments must outlive it.
    MapSummary(const propagation::Scene& scene,
               const propagation::MetricMap& map,
               const std::vector<propagation::MapLimit>& limits);

    /// The share of the area that keeps a limit, of all limits and sources the smallest; 1 without
    /// limits.
    double min_share() const noexcept;

    std::string text(double seconds, const std::vector<std::string>& files) const;
    std::string json(double seconds, const std::vector<std::string>& files) const;

private:
    struct Range {
        std::size_t known = 0;  // cells with a value
        double min = 0.0, median = 0.0, max = 0.0;
        double standard_error = 0.0;  // the median of all
    };
    struct LimitAnswer {
        const propagation::MapLimit* limit;
        std::size_t source;
        propagation::MapLimitResult result;
    };

    Range range_of(std::size_t source, std::size_t metric) const;
    std::string limit_text(const LimitAnswer& answer) const;
    double area() const;

    const propagation::Scene& scene_;
    const propagation::MetricMap& map_;
    std::vector<LimitAnswer> answers_;
};

}  // namespace earshot::cli
