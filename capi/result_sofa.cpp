// SPDX-License-Identifier: MIT
// Responses of results as a SOFA file.
#include "earshot/capi/internal/checks.h"
#include "earshot/capi/internal/result_object.h"
#include "earshot/capi/internal/sofa.h"
#include "earshot/io/whole_file.h"

#include <memory>
#include <string>
#include <vector>

namespace earshot::capi {
namespace {

/// The results of handles, in use while this exists.
class ResultList {
public:
    ResultList(const es_result* results, std::size_t count) {
        constexpr std::size_t kMaxResults = std::size_t{1} << 24U;
        require_count(count, 1, kMaxResults, "count");
        for (const es_result handle : require_array(results, count, "results")) {
            list_.push_back(std::make_unique<Reading<ResultObject>>(handle, "results"));
        }
    }

    std::size_t size() const noexcept { return list_.size(); }
    const ResultObject& operator[](std::size_t i) const noexcept { return **list_[i]; }

private:
    std::vector<std::unique_ptr<Reading<ResultObject>>> list_;
};

void require_agreement(const ResultObject& result, const ResultObject& first, std::size_t number) {
    const std::string argument = "results[" + std::to_string(number) + "]";
    if (result.measurements.empty()) {
        throw Error(argument,
                    "does not hold responses of 64 bits",
                    "simulate with es_simulation_options::sofa = 1");
    }
    if (result.channels != first.channels || result.info.channels != first.info.channels ||
        result.info.sample_rate != first.info.sample_rate) {
        throw Error(argument,
                    "differs from the first in format or sample rate",
                    "give results of the same options");
    }
}

}  // namespace
}  // namespace earshot::capi

using namespace earshot;
using namespace earshot::capi;

es_status es_results_write_sofa(const es_result* results, size_t count, const char* file) {
    return call(__func__, [&] {
        const std::string path(require_text(file, "file"));
        const ResultList list(results, count);
        std::vector<io::RoomMeasurement> measurements;
        for (std::size_t i = 0; i < list.size(); ++i) {
            require_agreement(list[i], list[0], i);
            measurements.insert(
                measurements.end(), list[i].measurements.begin(), list[i].measurements.end());
        }
        io::write_whole_file(
            path, encode_room_responses(path, list[0].names.name, list[0].channels, measurements));
    });
}
