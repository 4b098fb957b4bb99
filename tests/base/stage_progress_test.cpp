// SPDX-License-Identifier: MIT
#include "earshot/base/stage_progress.h"

#include "earshot/base/parallel.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace earshot::test {
namespace {

class Reports : public Progress {
public:
    void report(std::string_view stage, std::size_t done, std::size_t total) override {
        stages.emplace_back(stage);
        counts.push_back(done);
        totals.push_back(total);
    }
    std::vector<std::string> stages;
    std::vector<std::size_t> counts, totals;
};

TEST(StageProgress, CountsStepsOfManyThreads) {
    Reports reports;
    {
        StageProgress stage(&reports, "work", 1000, 100);
        Executor executor(4);
        executor.for_each(
            900, 3, [&](std::size_t begin, std::size_t end) { stage.add(end - begin); });
    }
    ASSERT_EQ(reports.counts.size(), 301U);
    for (std::size_t i = 0; i < reports.counts.size(); ++i) {
        EXPECT_EQ(reports.counts[i], 100 + 3 * i);
        EXPECT_EQ(reports.totals[i], 1000U);
        EXPECT_EQ(reports.stages[i], "work");
    }
}

TEST(StageProgress, MayEndBeforeAllStepsAreDone) {
    Reports reports;
    StageProgress stage(&reports, "work", 10);
    stage.add(4);
    stage.finish();
    stage.finish();
    EXPECT_EQ(reports.counts, (std::vector<std::size_t>{0, 4, 10}));
}

TEST(StageProgress, NeedsNobodyToReportTo) {
    StageProgress stage(nullptr, "work", 1);
    stage.add(1);
}

}  // namespace
}  // namespace earshot::test
