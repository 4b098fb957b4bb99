// SPDX-License-Identifier: MIT
// Random sequences of calls of the C interface with handles, sizes, numbers and indices of which
// some are wrong: PROGRAM [CALLS [SEED]]. No call may crash or fail for an internal reason, a call
// with a wrong argument must fail, and what fails must be told.
#include "capi/fuzz_caller.h"
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

namespace {

using namespace earshot::capi_fuzz;

std::vector<WeightedCall> all_calls() {
    std::vector<WeightedCall> calls;
    for (const auto* some : {&scene_calls(),
                             &simulation_calls(),
                             &model_calls(),
                             &query_calls(),
                             &location_calls(),
                             &engine_calls()}) {
        calls.insert(calls.end(), some->begin(), some->end());
    }
    return calls;
}

/// What is wrong with the outcome of a call; empty if nothing is.
std::string complaint(const Caller& caller, es_status status) {
    if (status < ES_OK || status > ES_ERROR_INTERNAL) {
        return "has no status that there is";
    }
    if (status == ES_ERROR_INTERNAL || status == ES_ERROR_BUSY || status == ES_ERROR_CANCELLED) {
        return "fails without a reason";
    }
    if (status == ES_OK) {
        return caller.wrong ? "takes a wrong argument" : "";
    }
    const bool is_told = es_error_status() == status && es_error_subject()[0] != '\0' &&
                         es_error_problem()[0] != '\0' &&
                         std::strstr(es_error_message(), es_error_problem()) != nullptr;
    return is_told ? "" : "does not tell why it fails";
}

/// How often each status was seen.
struct Counts {
    std::uint64_t of_status[ES_ERROR_INTERNAL + 1] = {};
};

bool run(std::uint64_t calls, std::uint64_t seed) {
    constexpr std::size_t kMaxLive = 40;
    const std::vector<WeightedCall> choices = all_calls();
    int weights = 0;
    for (const WeightedCall& choice : choices) {
        weights += choice.weight;
    }
    Caller caller(seed);
    Counts counts;
    for (std::uint64_t i = 0; i < calls; ++i) {
        caller.begin();
        while (caller.live_count() > kMaxLive) {
            if (es_release(caller.take()) != ES_OK) {
                std::fprintf(stderr,
                             "call %llu: a live object is not released\n",
                             static_cast<unsigned long long>(i));
                return false;
            }
        }
        int pick = caller.below(weights);
        const WeightedCall* choice = choices.data();
        while (pick >= choice->weight) {
            pick -= choice->weight;
            ++choice;
        }
        const es_status status = choice->call(caller);
        const std::string problem = complaint(caller, status);
        if (!problem.empty()) {
            std::fprintf(stderr,
                         "call %llu of seed %llu: %s %s: %s: %s\n",
                         static_cast<unsigned long long>(i),
                         static_cast<unsigned long long>(seed),
                         choice->name,
                         problem.c_str(),
                         es_status_name(status),
                         es_error_message());
            return false;
        }
        ++counts.of_status[status];
    }
    while (caller.live_count() > 0) {
        static_cast<void>(es_release(caller.take()));
    }
    for (int status = ES_OK; status <= ES_ERROR_INTERNAL; ++status) {
        std::printf("%s %llu\n",
                    es_status_name(status),
                    static_cast<unsigned long long>(counts.of_status[status]));
    }
    if (es_object_count() != 0) {
        std::fprintf(stderr, "%zu objects are left\n", es_object_count());
        return false;
    }
    return true;
}

}  // namespace

int main(int argc, char** argv) {
    const std::uint64_t calls = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 50000;
    const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
    return run(calls, seed) ? EXIT_SUCCESS : EXIT_FAILURE;
}
