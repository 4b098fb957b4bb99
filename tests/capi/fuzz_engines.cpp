// SPDX-License-Identifier: MIT
// Calls on engines.
#include "capi/fuzz_caller.h"

namespace earshot::capi_fuzz {
namespace {

constexpr std::size_t kBlock = 32;

es_status make_engine(Caller& c) {
    const es_scene scene = c.handle(ES_KIND_SCENE);
    es_simulation_options simulation = simulation_options_of(c);
    es_engine_options given;
    es_engine_options_init(&given, sizeof given);
    given.order = c.choice(2);
    given.rays = c.chance(0.03) ? 32 : 0;
    given.block = c.chance(0.97) ? kBlock : 33;
    c.wrong = c.wrong || given.block != kBlock;
    given.any_frame_count = c.flag();
    given.motion_delay = c.number(0.0, 10.0, {0.0, 0.1});
    given.max_delay = c.number(1e-3, 10.0, {0.01, 0.1});
    given.max_paths = static_cast<std::uint32_t>(1 + c.below(10));
    given.max_filters = static_cast<std::uint32_t>(1 + c.below(4));
    given.late_length = c.number(0.0, 20.0, {0.01, 0.1});
    given.update_interval = c.number(0.0, 60.0, {0.0, 0.1});
    given.budget_work = c.chance(0.5) ? 0 : c.count(100);
    es_engine engine = 0;
    return kept(c, es_engine_create(scene, &simulation, &given, c.out(engine)), engine);
}

es_status render(Caller& c, es_engine engine, const es_engine_info& info) {
    const std::size_t frames = kBlock * c.count(8);
    const std::vector<float> in(info.sources * frames, 0.5F);
    std::vector<float> out(info.listeners * info.channels * frames);
    const es_status status = es_engine_render(engine, in.data(), frames, out.data());
    keep_reading(sum(out.data(), out.size()));
    return status;
}

es_status use_engine(Caller& c) {
    const es_engine engine = c.handle(ES_KIND_ENGINE);
    es_engine_info info{};
    info.struct_size = sizeof info;
    static_cast<void>(es_engine_get_info(engine, &info));
    switch (c.below(9)) {
        case 0: {
            const std::size_t source = c.index(info.sources);
            const double* place = c.points(1);
            return es_engine_place_source(engine, source, place, nullptr);
        }
        case 1: {
            const std::size_t listener = c.index(info.listeners);
            return es_engine_place_listener(engine, listener, c.points(1));
        }
        case 2:
            return es_engine_set_time(engine, c.number(-1e12, 1e12));
        case 3:
            return es_engine_publish(engine);
        case 4:
            return es_engine_update(engine);
        case 5: {
            es_engine_statistics statistics{};
            statistics.struct_size = sizeof statistics;
            return es_engine_get_statistics(engine, c.out(statistics));
        }
        case 6: {
            const double front[3] = {1.0, 0.0, 0.0};
            const std::size_t listener = c.index(info.listeners);
            return es_engine_turn_listener(engine, listener, front, c.points(1));
        }
        case 7: {
            es_renderer* renderer = nullptr;
            return es_engine_renderer(engine, c.out(renderer));
        }
        default:
            return render(c, engine, info);
    }
}

}  // namespace

const std::vector<WeightedCall>& engine_calls() {
    static const std::vector<WeightedCall> kCalls{{"make_engine", make_engine, 1},
                                                  {"use_engine", use_engine, 12}};
    return kCalls;
}

}  // namespace earshot::capi_fuzz
