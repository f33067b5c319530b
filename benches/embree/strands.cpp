// Rays through strands with Embree's linear curves: the yardstick of benches/embree/strands.rs.
//
//   strands SCENE RESULTS
//
// SCENE, as the Rust side writes it, little-endian: three u32 (joints, segments, sets of rays), four f32 a joint
// (millimeters, half width), one u32 a segment (the joint it starts at), then for each set a u32 (rays) and six
// f32 a ray (origin, unit direction). For each line `SET KIND QUERY THREADS` of standard input (KIND flat or
// round, QUERY closest or occluded or write) answers
//
//   seconds hits
//
// with the processor time of all threads. `write` is closest on one thread, and for each ray RESULTS receives a u32
// (segment, or all ones) and an f32 (distance). Before, it says on one line how long the builds of both
// kinds took by the clock and by the processor, and the bytes that Embree then holds. Embree 4 or 3.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

struct Joint { float x, y, z, r; };
struct Ray { float o[3], d[3]; };

static double seconds(clockid_t clock) {
    timespec t;
    clock_gettime(clock, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

static std::atomic<long long> held{0};
static bool count(void *, ssize_t bytes, bool) {
    held += bytes;
    return true;
}

template <typename T> static std::vector<T> read(std::istream &in, size_t n) {
    std::vector<T> all(n);
    in.read(reinterpret_cast<char *>(all.data()), std::streamsize(n * sizeof(T)));
    return all;
}

static RTCScene build(RTCDevice device, RTCGeometryType type, const std::vector<Joint> &joints,
                      const std::vector<uint32_t> &segments) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    RTCGeometry curves = rtcNewGeometry(device, type);
    rtcSetGeometryBuildQuality(curves, RTC_BUILD_QUALITY_HIGH);
    rtcSetSharedGeometryBuffer(curves, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4, joints.data(), 0,
                               sizeof(Joint), joints.size());
    rtcSetSharedGeometryBuffer(curves, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, segments.data(), 0,
                               sizeof(uint32_t), segments.size());
    if (type == RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE) {
        // Which ends go on in a neighbor.
        auto *flags = static_cast<uint8_t *>(rtcSetNewGeometryBuffer(curves, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR,
                                                                     1, segments.size()));
        for (size_t i = 0; i < segments.size(); i++) {
            bool left = i > 0 && segments[i - 1] + 1 == segments[i];
            bool right = i + 1 < segments.size() && segments[i] + 1 == segments[i + 1];
            flags[i] = uint8_t((left ? RTC_CURVE_FLAG_NEIGHBOR_LEFT : 0) | (right ? RTC_CURVE_FLAG_NEIGHBOR_RIGHT : 0));
        }
    }
    rtcCommitGeometry(curves);
    rtcAttachGeometry(scene, curves);
    rtcReleaseGeometry(curves);
    rtcCommitScene(scene);
    return scene;
}

static uint64_t trace(RTCScene scene, const Ray *rays, size_t n, bool occluded, std::ostream *results) {
    uint64_t hits = 0;
#if RTC_VERSION_MAJOR < 4
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#endif
    for (size_t i = 0; i < n; i++) {
        RTCRayHit r;
        r.ray.org_x = rays[i].o[0];
        r.ray.org_y = rays[i].o[1];
        r.ray.org_z = rays[i].o[2];
        r.ray.tnear = 0;
        r.ray.dir_x = rays[i].d[0];
        r.ray.dir_y = rays[i].d[1];
        r.ray.dir_z = rays[i].d[2];
        r.ray.time = 0;
        r.ray.tfar = INFINITY;
        r.ray.mask = ~0u;
        r.ray.flags = 0;
        if (occluded) {
#if RTC_VERSION_MAJOR < 4
            rtcOccluded1(scene, &context, &r.ray);
#else
            rtcOccluded1(scene, &r.ray);
#endif
            hits += r.ray.tfar < 0;
            continue;
        }
        r.hit.geomID = r.hit.primID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR < 4
        rtcIntersect1(scene, &context, &r);
#else
        rtcIntersect1(scene, &r);
#endif
        bool hit = r.hit.geomID != RTC_INVALID_GEOMETRY_ID;
        hits += hit;
        if (results) {
            uint32_t segment = hit ? r.hit.primID : ~0u;
            results->write(reinterpret_cast<const char *>(&segment), sizeof segment);
            results->write(reinterpret_cast<const char *>(&r.ray.tfar), sizeof r.ray.tfar);
        }
    }
    return hits;
}

int main(int argc, char **argv) {
    std::ifstream in(argc == 3 ? argv[1] : "", std::ios::binary);
    if (!in) {
        std::fprintf(stderr, "see the head of strands.cpp for what this program is asked\n");
        return 2;
    }
    auto counts = read<uint32_t>(in, 3);
    auto joints = read<Joint>(in, counts[0]);
    auto segments = read<uint32_t>(in, counts[1]);
    std::vector<std::vector<Ray>> sets;
    for (uint32_t i = 0; i < counts[2]; i++) sets.push_back(read<Ray>(in, read<uint32_t>(in, 1)[0]));
    joints.push_back({}); // Embree reads 16 bytes beyond

    RTCScene scenes[2];
    for (int kind = 0; kind < 2; kind++) {
        RTCDevice device = rtcNewDevice("threads=2");
        if (kind == 0) std::printf("%ld.%ld", long(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR)),
                                   long(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MINOR)));
        held = 0;
        rtcSetDeviceMemoryMonitorFunction(device, count, nullptr);
        auto clock = std::chrono::steady_clock::now();
        double processor = seconds(CLOCK_PROCESS_CPUTIME_ID);
        scenes[kind] = build(device, kind ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE : RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE,
                             joints, segments);
        std::chrono::duration<double> passed = std::chrono::steady_clock::now() - clock;
        std::printf(" %f %f %lld", passed.count(), seconds(CLOCK_PROCESS_CPUTIME_ID) - processor, held.load());
    }
    std::printf("\n");
    std::fflush(stdout);

    size_t set, threads;
    std::string kind, query;
    while (std::cin >> set >> kind >> query >> threads) {
        RTCScene scene = scenes[kind == "round"];
        const std::vector<Ray> &rays = sets[set];
        std::ofstream file;
        if (query == "write") file.open(argv[2], std::ios::binary);
        std::atomic<uint64_t> hits{0}, nanoseconds{0};
        // Small pieces, so that both threads have work to the end.
        std::atomic<size_t> next{0};
        const size_t piece = threads == 1 ? rays.size() : 4096;
        auto work = [&] {
            double start = seconds(CLOCK_THREAD_CPUTIME_ID);
            for (size_t at; (at = next.fetch_add(piece)) < rays.size();)
                hits += trace(scene, &rays[at], std::min(piece, rays.size() - at), query == "occluded",
                              query == "write" ? &file : nullptr);
            nanoseconds += uint64_t(1e9 * (seconds(CLOCK_THREAD_CPUTIME_ID) - start));
        };
        std::vector<std::thread> others;
        for (size_t i = 1; i < threads; i++) others.emplace_back(work);
        work();
        for (auto &other : others) other.join();
        file.close();
        std::printf("%.9f %llu\n", 1e-9 * double(nanoseconds), (unsigned long long)hits);
        std::fflush(stdout);
    }
}
