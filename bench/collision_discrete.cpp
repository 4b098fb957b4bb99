// SPDX-License-Identifier: MIT
//
// bench_collision_discrete MESH_A MESH_B [POSES]: two meshes, scaled to a diagonal of 1, at random
// poses of the second: building, whether they intersect, how far apart they are, all contacts.
// Beside FCL and Coal, question by question in turns, where they were there at configure time. One
// thread.

#include "earshot/base/digest.h"
#include "earshot/base/error.h"
#include "earshot/base/random.h"
#include "earshot/io/scene_file.h"

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "collision_contenders.h"
#include "harness.h"
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>

namespace bench {
namespace {

using earshot::collision::Body;
using earshot::collision::Pose;
using earshot::collision::Shape;
using earshot::collision::TrianglePair;
using earshot::geometry::Mesh;
using earshot::geometry::MeshView;
using earshot::geometry::Vec3;

class Earshot : public DiscreteContender {
public:
    void build(const MeshView& a, const MeshView& b) override {
        a_ = Shape::build(a);
        b_ = Shape::build(b);
    }
    void refit(const MeshView& a, const MeshView& b) override {
        a_.update(a);
        b_.update(b);
    }
    bool intersects(const Pose& pose) override {
        return earshot::collision::intersects({a_}, {b_, pose});
    }
    double distance(const Pose& pose) override {
        return earshot::collision::distance({a_}, {b_, pose}).distance;
    }
    std::vector<TrianglePair> contacts(const Pose& pose) override {
        auto pairs = earshot::collision::find_contacts({a_}, {b_, pose});
        segments_ = earshot::collision::contact_segments({a_}, {b_, pose}, pairs);
        return pairs;
    }

private:
    Shape a_, b_;
    std::vector<earshot::geometry::Segment> segments_;
};

Mesh load(const char* file) {
    const auto scene = earshot::io::load_scene(file).scene;
    Mesh mesh = {scene.mesh.positions_at(0.0),
                 {scene.mesh.triangles().begin(), scene.mesh.triangles().end()}};
    Vec3 lower = mesh.positions.front();
    Vec3 upper = lower;
    for (const Vec3& position : mesh.positions) {
        lower = glm::min(lower, position);
        upper = glm::max(upper, position);
    }
    for (Vec3& position : mesh.positions) {
        position = (position - 0.5 * (lower + upper)) / glm::length(upper - lower);
    }
    return mesh;
}

Pose random_pose(std::uint64_t i) {
    constexpr double kFar = 0.5;
    const auto point = [&](std::uint64_t k, double far) {
        return Vec3(earshot::random_between(1, k, i, -far, far),
                    earshot::random_between(1, k + 1, i, -far, far),
                    earshot::random_between(1, k + 2, i, -far, far));
    };
    const Vec3 x = glm::normalize(point(0, 1.0));
    const Vec3 y = glm::normalize(glm::cross(x, point(3, 1.0)));
    return {{x, y, glm::cross(x, y)}, point(6, kFar)};
}

/// Of the calling thread, microseconds: what else the machine does counts for little.
double processor_us() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e6 * static_cast<double>(now.tv_sec) + 1e-3 * static_cast<double>(now.tv_nsec);
}

/// Microseconds of processor time of every call.
struct Times {
    std::vector<double> each;

    double measure(const std::function<void()>& call) {
        const double start = processor_us();
        call();
        each.push_back(processor_us() - start);
        return each.back();
    }
    double mean() const {
        double sum = 0.0;
        for (const double time : each) {
            sum += time;
        }
        return each.empty() ? 0.0 : sum / static_cast<double>(each.size());
    }
    double at(double quantile) const {
        std::vector<double> sorted = each;
        std::sort(sorted.begin(), sorted.end());
        return sorted.empty() ? 0.0
                              : sorted[static_cast<std::size_t>(
                                    quantile * static_cast<double>(sorted.size() - 1))];
    }
};

struct Run {
    std::string name;
    std::unique_ptr<DiscreteContender> contender;
    Times build{}, intersects{}, distance{}, contacts{};
    DiscreteAnswers answers{};
};

void ask(Run& run, const Pose& pose) {
    bool intersects = false;
    double distance = 0.0;
    std::vector<TrianglePair> pairs;
    run.intersects.measure([&] { intersects = run.contender->intersects(pose); });
    run.distance.measure([&] { distance = run.contender->distance(pose); });
    Times all;
    all.measure([&] { pairs = run.contender->contacts(pose); });
    if (intersects) {
        run.contacts.each.push_back(all.mean());
    }
    std::sort(pairs.begin(), pairs.end());
    run.answers.intersects.push_back(intersects);
    run.answers.distances.push_back(intersects ? 0.0 : distance);
    run.answers.contacts.push_back(std::move(pairs));
}

void print(const std::vector<Run>& runs) {
    const auto line = [&](const char* what, Times Run::*times) {
        for (const Run& run : runs) {
            const Times& t = run.*times;
            std::printf("| %s | %s | %zu | %.1f | %.1f | %.1f | %.1f | %.2f |\n",
                        what,
                        run.name.c_str(),
                        t.each.size(),
                        t.mean(),
                        t.at(0.5),
                        t.at(0.99),
                        t.at(0.0),
                        t.mean() / (runs.front().*times).mean());
        }
    };
    std::printf("| us | library | times | mean | median | 99 %% | minimum | mean / earshot's |\n");
    std::printf("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: |\n");
    line("build both", &Run::build);
    line("intersect?", &Run::intersects);
    line("distance", &Run::distance);
    line("all contacts, where they intersect", &Run::contacts);
}

void print_digest(const Run& run) {
    earshot::Digest digest;
    std::size_t contacts = 0;
    for (std::size_t i = 0; i < run.answers.intersects.size(); ++i) {
        digest.add(run.answers.distances[i]);
        for (const TrianglePair& pair : run.answers.contacts[i]) {
            digest.add(pair.a);
            digest.add(pair.b);
            ++contacts;
        }
    }
    std::printf("%s: %td poses intersect, %zu contacts, digest %016llx\n",
                run.name.c_str(),
                std::count(run.answers.intersects.begin(), run.answers.intersects.end(), true),
                contacts,
                static_cast<unsigned long long>(digest.value()));
}

void print_differences(const Run& one, const Run& other) {
    std::size_t intersects = 0;
    std::size_t missing = 0;
    std::size_t more = 0;
    double largest = 0.0;
    for (std::size_t i = 0; i < one.answers.intersects.size(); ++i) {
        intersects += one.answers.intersects[i] != other.answers.intersects[i] ? 1 : 0;
        largest =
            std::max(largest, std::abs(one.answers.distances[i] - other.answers.distances[i]));
        std::vector<TrianglePair> only;
        const auto& p = one.answers.contacts[i];
        const auto& q = other.answers.contacts[i];
        std::set_difference(p.begin(), p.end(), q.begin(), q.end(), std::back_inserter(only));
        missing += only.size();
        only.clear();
        std::set_difference(q.begin(), q.end(), p.begin(), p.end(), std::back_inserter(only));
        more += only.size();
    }
    std::printf(
        "%s against %s: %zu poses differ, distances by %.2g at most; it lacks %zu contacts "
        "and has %zu others\n",
        other.name.c_str(),
        one.name.c_str(),
        intersects,
        largest,
        missing,
        more);
}

int run(int argc, char** argv) {
    if (argc < 3) {
        std::fprintf(stderr, "bench_collision_discrete MESH_A MESH_B [POSES]\n");
        return 2;
    }
    const Mesh a = load(argv[1]);
    const Mesh b = load(argv[2]);
    const int poses = argc > 3 ? std::atoi(argv[3]) : 1000;
    std::printf("%zu and %zu triangles\n\n", a.triangles.size(), b.triangles.size());
    std::vector<Run> runs;
    runs.push_back({"earshot", std::make_unique<Earshot>()});
    if (auto fcl = fcl_contender()) {
        runs.push_back({"FCL", std::move(fcl)});
    }
    if (auto coal = coal_contender()) {
        runs.push_back({"Coal", std::move(coal)});
    }
    for (int repeat = 0; repeat < 5; ++repeat) {
        for (Run& each : runs) {
            each.build.measure([&] { each.contender->build(a.view(), b.view()); });
        }
    }
    for (int i = 0; i < poses; ++i) {
        for (Run& each : runs) {
            ask(each, random_pose(static_cast<std::uint64_t>(i)));
        }
    }
    print(runs);
    std::printf("\n");
    for (const Run& each : runs) {
        print_digest(each);
    }
    for (std::size_t i = 1; i < runs.size(); ++i) {
        print_differences(runs[0], runs[i]);
    }
    return 0;
}

}  // namespace
}  // namespace bench

int main(int argc, char** argv) {
    return bench::run_main("bench_collision_discrete", argc, argv, bench::run);
}
