// SPDX-License-Identifier: MIT
#include "bvh_contenders.h"
#include <algorithm>
#include <atomic>
#include <cmath>
#include <embree3/rtcore.h>
#include <limits>
#include <xmmintrin.h>

namespace bench {
namespace {

/// What Embree takes of a ray or segment.
struct FloatRay {
    float origin[3], direction[3], most;
};

struct FloatHit {
    float t;
    unsigned triangle;
};

/// Embree's setting of the instruction set that is nearest to one of earshot's.
std::string isa_of(const std::string& simd) {
    if (simd == "auto") {
        return {};
    }
    const bool is_avx512 = simd.starts_with("avx512");
    return is_avx512 ? ",isa=avx512" : simd == "avx2" ? ",isa=avx2" : ",isa=sse4.2";
}

bool count_memory(void* total, ssize_t bytes, bool) {
    *static_cast<std::atomic<long>*>(total) += static_cast<long>(bytes);
    return true;
}

class Embree : public Contender {
public:
    Embree(std::string name,
           RTCBuildQuality quality,
           int flags,
           const std::string& device,
           bool packets)
        : name_(std::move(name)), quality_(quality), flags_(flags), is_packets_(packets) {
        // As its manual asks of every thread that traces.
        _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
        device_ = rtcNewDevice(device.c_str());
        rtcSetDeviceMemoryMonitorFunction(device_, count_memory, &memory_);
    }
    ~Embree() override {
        release();
        rtcReleaseDevice(device_);
    }
    Embree(const Embree&) = delete;
    Embree& operator=(const Embree&) = delete;

    std::string name() const override { return name_; }

    void build(const MeshView& mesh, Executor&) override {
        release();
        scene_ = rtcNewScene(device_);
        rtcSetSceneFlags(scene_, static_cast<RTCSceneFlags>(flags_));
        rtcSetSceneBuildQuality(scene_, quality_);
        geometry_ = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
        rtcSetGeometryBuildQuality(geometry_, quality_);
        vertices_ = static_cast<float*>(rtcSetNewGeometryBuffer(geometry_,
                                                                RTC_BUFFER_TYPE_VERTEX,
                                                                0,
                                                                RTC_FORMAT_FLOAT3,
                                                                3 * sizeof(float),
                                                                mesh.positions.size()));
        auto* indices = static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry_,
                                                                       RTC_BUFFER_TYPE_INDEX,
                                                                       0,
                                                                       RTC_FORMAT_UINT3,
                                                                       3 * sizeof(unsigned),
                                                                       mesh.triangles.size()));
        set_vertices(mesh);
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            std::copy(mesh.triangles[i].begin(), mesh.triangles[i].end(), indices + 3 * i);
        }
        rtcCommitGeometry(geometry_);
        rtcAttachGeometry(scene_, geometry_);
        rtcCommitScene(scene_);
    }

    bool refit(const MeshView& mesh, Executor&) override {
        if (quality_ != RTC_BUILD_QUALITY_LOW) {
            return false;
        }
        rtcSetGeometryBuildQuality(geometry_, RTC_BUILD_QUALITY_REFIT);
        set_vertices(mesh);
        rtcUpdateGeometryBuffer(geometry_, RTC_BUFFER_TYPE_VERTEX, 0);
        rtcCommitGeometry(geometry_);
        rtcCommitScene(scene_);
        return true;
    }

    std::size_t bytes() const override { return static_cast<std::size_t>(memory_.load()); }

    void prepare(const std::vector<Ray>& rays) override {
        rays_.clear();
        for (const Ray& ray : rays) {
            rays_.push_back(float_ray(ray.origin, ray.direction, ray.t_max));
        }
        hits_.resize(rays.size());
    }
    void prepare(const std::vector<Segment>& segments) override {
        rays_.clear();
        for (const Segment& segment : segments) {
            rays_.push_back(float_ray(segment.from, segment.to - segment.from, 1.0));
        }
        blocked_.resize(segments.size());
    }

    std::size_t closest(Executor& executor) override {
        std::atomic<std::size_t> found = 0;
        executor.for_each(rays_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            found += is_packets_ ? closest_in_packets(begin, end) : closest_singly(begin, end);
        });
        return found;
    }

    std::size_t any(Executor& executor) override {
        std::atomic<std::size_t> found = 0;
        executor.for_each(rays_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
            RTCIntersectContext context;
            rtcInitIntersectContext(&context);
            std::size_t hits = 0;
            for (std::size_t i = begin; i < end; ++i) {
                RTCRay ray;
                fill(ray, rays_[i]);
                rtcOccluded1(scene_, &context, &ray);
                blocked_[i] = ray.tfar < 0.0F ? 1 : 0;
                hits += blocked_[i];
            }
            found += hits;
        });
        return found;
    }

private:
    static FloatRay float_ray(const earshot::geometry::Vec3& from,
                              const earshot::geometry::Vec3& direction,
                              double most) {
        FloatRay ray;
        for (int k = 0; k < 3; ++k) {
            ray.origin[k] = static_cast<float>(from[k]);
            ray.direction[k] = static_cast<float>(direction[k]);
        }
        ray.most = static_cast<float>(most);
        return ray;
    }

    static void fill(RTCRay& ray, const FloatRay& source) {
        ray.org_x = source.origin[0];
        ray.org_y = source.origin[1];
        ray.org_z = source.origin[2];
        ray.tnear = 0.0F;
        ray.dir_x = source.direction[0];
        ray.dir_y = source.direction[1];
        ray.dir_z = source.direction[2];
        ray.time = 0.0F;
        ray.tfar = source.most;
        ray.mask = std::numeric_limits<unsigned>::max();
        ray.id = 0;
        ray.flags = 0;
    }

    std::size_t closest_singly(std::size_t begin, std::size_t end) {
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        std::size_t found = 0;
        for (std::size_t i = begin; i < end; ++i) {
            RTCRayHit query;
            fill(query.ray, rays_[i]);
            query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
            query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
            rtcIntersect1(scene_, &context, &query);
            hits_[i] = {query.ray.tfar, query.hit.primID};
            found += query.hit.geomID != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
        }
        return found;
    }

    std::size_t closest_in_packets(std::size_t begin, std::size_t end) {
        constexpr std::size_t kWidth = 16;
        RTCIntersectContext context;
        rtcInitIntersectContext(&context);
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        std::size_t found = 0;
        for (std::size_t first = begin; first < end; first += kWidth) {
            alignas(64) int valid[kWidth];
            RTCRayHit16 query;
            for (std::size_t k = 0; k < kWidth; ++k) {
                const std::size_t i = std::min(first + k, end - 1);
                valid[k] = first + k < end ? -1 : 0;
                query.ray.org_x[k] = rays_[i].origin[0];
                query.ray.org_y[k] = rays_[i].origin[1];
                query.ray.org_z[k] = rays_[i].origin[2];
                query.ray.tnear[k] = 0.0F;
                query.ray.dir_x[k] = rays_[i].direction[0];
                query.ray.dir_y[k] = rays_[i].direction[1];
                query.ray.dir_z[k] = rays_[i].direction[2];
                query.ray.time[k] = 0.0F;
                query.ray.tfar[k] = rays_[i].most;
                query.ray.mask[k] = std::numeric_limits<unsigned>::max();
                query.ray.id[k] = 0;
                query.ray.flags[k] = 0;
                query.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
                query.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect16(valid, scene_, &context, &query);
            for (std::size_t k = 0; k < kWidth && first + k < end; ++k) {
                hits_[first + k] = {query.ray.tfar[k], query.hit.primID[k]};
                found += query.hit.geomID[k] != RTC_INVALID_GEOMETRY_ID ? 1 : 0;
            }
        }
        return found;
    }

    void set_vertices(const MeshView& mesh) {
        for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
            for (int k = 0; k < 3; ++k) {
                vertices_[3 * i + static_cast<std::size_t>(k)] =
                    static_cast<float>(mesh.positions[i][k]);
            }
        }
    }

    void release() {
        if (scene_ != nullptr) {
            rtcReleaseGeometry(geometry_);
            rtcReleaseScene(scene_);
            scene_ = nullptr;
        }
    }

    std::string name_;
    RTCBuildQuality quality_;
    int flags_;
    bool is_packets_;
    std::atomic<long> memory_ = 0;
    RTCDevice device_ = nullptr;
    RTCScene scene_ = nullptr;
    RTCGeometry geometry_ = nullptr;
    float* vertices_ = nullptr;
    std::vector<FloatRay> rays_;
    std::vector<FloatHit> hits_;
    std::vector<std::uint8_t> blocked_;
};

}  // namespace

std::vector<std::unique_ptr<Contender>> embree_contenders(int threads, const std::string& simd) {
    std::vector<std::unique_ptr<Contender>> contenders;
    const std::string device = "threads=" + std::to_string(threads) + isa_of(simd);
    const auto add = [&](const char* name, RTCBuildQuality quality, int flags, bool packets) {
        contenders.push_back(std::make_unique<Embree>(name, quality, flags, device, packets));
    };
    add("embree medium", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_NONE, false);
    add("embree robust", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_ROBUST, false);
    add("embree high", RTC_BUILD_QUALITY_HIGH, RTC_SCENE_FLAG_NONE, false);
    add("embree low", RTC_BUILD_QUALITY_LOW, RTC_SCENE_FLAG_DYNAMIC, false);
    add("embree compact", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_COMPACT, false);
    add("embree packets", RTC_BUILD_QUALITY_MEDIUM, RTC_SCENE_FLAG_NONE, true);
    return contenders;
}

}  // namespace bench
