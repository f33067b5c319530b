// Photons through the triangles of a fiber with Embree: the yardstick of benches/embree/main.rs.
//
// The physics is that of `vair bake` on smooth dielectric boundaries: entry evenly over inclination,
// width, length and rotation, Fresnel by chance, voids as the union of closed bodies, periodic along
// z, a limit of events. Nothing is tallied. Single precision, one thread.
//
//   photons FIBER.ply PERIOD_UM CORTEX_IOR VOID_IOR MAX_EVENTS COPIES ROBUST
//
// FIBER.ply is what `vair fiber NAME -o FIBER.ply` writes; one period is copied COPIES times to both
// sides, so that rays are seldom cut at an end. For each line `WIDTH PHOTONS SEED` of standard input
// (WIDTH 1, 4, 8 or 16 rays at a time) answers
//
//   seconds segments events escaped truncated lost
//
// with seconds of this thread's processor time. Embree 4 or 3.
#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

struct Vec { float x, y, z; };
static inline Vec operator+(Vec a, Vec b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
static inline Vec operator-(Vec a, Vec b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
static inline Vec operator*(float s, Vec a) { return {s * a.x, s * a.y, s * a.z}; }
static inline float dot(Vec a, Vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec cross(Vec a, Vec b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static inline Vec unit(Vec a) { return (1.0f / std::sqrt(dot(a, a))) * a; }

// PCG-XSH-RR, as Vair draws its numbers.
struct Rng {
    uint64_t state, increment;
    static uint64_t mix(uint64_t x) {
        x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
        x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
        return x ^ (x >> 31);
    }
    Rng(uint64_t seed, uint64_t index) {
        uint64_t b = mix(index + mix(seed + 0x9e3779b97f4a7c15u));
        state = mix(b ^ 0xd1b54a32d192ed03u);
        increment = (b << 1) | 1;
    }
    float uniform() {
        uint64_t old = state;
        state = old * 6364136223846793005u + increment;
        uint32_t mixed = uint32_t(((old >> 18) ^ old) >> 27), turn = uint32_t(old >> 59);
        mixed = (mixed >> turn) | (mixed << ((32 - turn) & 31));
        return float(mixed >> 8) * (1.0f / 16777216.0f);
    }
};

struct Fiber {
    RTCScene scene;
    std::vector<Vec> normal;      // unit, outward, by primitive
    std::vector<uint8_t> is_void; // by primitive
    float period, low, high;      // in radii; rays end at the planes low and high
    float cortex, air;
    int max_events;
};

// How many radii a ray starts off the triangle that it leaves.
const float OFF = 1e-5f;

static Fiber load(int argc, char **argv) {
    if (argc != 8) {
        std::fprintf(stderr, "see the head of photons.cpp for what this program is asked\n");
        std::exit(2);
    }
    std::ifstream in(argv[1], std::ios::binary);
    std::string line;
    size_t points = 0, faces = 0;
    std::vector<std::string> parts;
    while (std::getline(in, line) && line != "end_header") {
        std::istringstream words(line);
        std::string a, b, c;
        words >> a >> b;
        if (a == "comment" && b == "part") {
            int number;
            words >> number >> c;
            parts.push_back(c);
        }
        if (b == "vertex") words >> points;
        if (b == "face") words >> faces;
    }
    std::vector<Vec> point(points);
    in.read(reinterpret_cast<char *>(point.data()), std::streamsize(points * sizeof(Vec)));
    std::vector<uint32_t> corner;
    std::vector<uint8_t> part;
    for (size_t i = 0; i < faces; i++) {
        char record[14];
        in.read(record, sizeof record);
        uint32_t v[3];
        std::memcpy(v, record + 1, sizeof v);
        corner.insert(corner.end(), v, v + 3);
        part.push_back(uint8_t(record[13]));
    }
    if (!in || !faces) {
        std::fprintf(stderr, "%s: not a mesh of a fiber\n", argv[1]);
        std::exit(2);
    }
    float radius = 0;
    for (size_t i = 0; i < corner.size(); i++) {
        if (parts[part[i / 3]] == "cuticle" || parts[part[i / 3]] == "riser") {
            Vec p = point[corner[i]];
            radius = std::max(radius, std::hypot(p.x, p.y));
        }
    }
    Fiber fiber;
    int copies = std::atoi(argv[6]);
    fiber.period = float(std::atof(argv[2]) / radius);
    fiber.cortex = float(std::atof(argv[3]));
    fiber.air = float(std::atof(argv[4]));
    fiber.max_events = std::atoi(argv[5]);
    // Bodies may reach over the end of their period: the last copy on each side is for those.
    fiber.low = float(1 - copies) * fiber.period;
    fiber.high = float(copies) * fiber.period;

    RTCDevice device = rtcNewDevice("threads=1");
    fiber.scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(fiber.scene, RTC_BUILD_QUALITY_HIGH);
    rtcSetSceneFlags(fiber.scene, std::atoi(argv[7]) ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryBuildQuality(mesh, RTC_BUILD_QUALITY_HIGH);
    size_t all = size_t(2 * copies + 1);
    auto *v = static_cast<Vec *>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                         sizeof(Vec), all * points));
    auto *t = static_cast<uint32_t *>(rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                              3 * sizeof(uint32_t), all * faces));
    for (size_t copy = 0; copy < all; copy++) {
        float up = (float(copy) - float(copies)) * fiber.period;
        for (size_t i = 0; i < points; i++) {
            Vec p = (1.0f / radius) * point[i];
            v[copy * points + i] = {p.x, p.y, p.z + up};
        }
        for (size_t i = 0; i < corner.size(); i++)
            t[copy * corner.size() + i] = uint32_t(copy * points) + corner[i];
        for (size_t i = 0; i < faces; i++) {
            Vec a = point[corner[3 * i]], b = point[corner[3 * i + 1]], c = point[corner[3 * i + 2]];
            fiber.normal.push_back(unit(cross(b - a, c - a)));
            const std::string &name = parts[part[i]];
            fiber.is_void.push_back(name == "void" || name == "medulla");
        }
    }
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(fiber.scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(fiber.scene);
    std::fprintf(stderr, "Embree %ld.%ld, %zu triangles a period\n",
                 long(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MAJOR)),
                 long(rtcGetDeviceProperty(device, RTC_DEVICE_PROPERTY_VERSION_MINOR)), faces);
    return fiber;
}

struct Sums { uint64_t segments = 0, events = 0, escaped = 0, truncated = 0, lost = 0; };

// A photon on its way: what one lane holds.
struct Photon {
    Rng rng{0, 0};
    Vec p, d;
    float near, far;  // range of the next search
    float turn[2];    // cosine and sine of the fiber's rotation, while it tries to enter
    int tries, cuts, events;
    int layers;       // of voids around it
    bool inside, entered, cut; // cut: the range ends at an end of the copies

    void start(const Fiber &f, uint64_t seed, uint64_t index) {
        rng = Rng(seed, index);
        float sin = 2 * rng.uniform() - 1, cos = std::sqrt(1 - sin * sin);
        float phi = 6.2831853f * rng.uniform();
        turn[0] = std::cos(phi);
        turn[1] = std::sin(phi);
        d = {-cos * turn[0], -cos * turn[1], -sin};
        tries = cuts = events = layers = 0;
        inside = entered = false;
        enter(f);
    }
    void enter(const Fiber &f) {
        float h = 2 * rng.uniform() - 1, x = std::sqrt(1 - h * h) + 1e-3f;
        p = {x * turn[0] - h * turn[1], x * turn[1] + h * turn[0], f.period * rng.uniform()};
        near = 0;
        tries++;
        limit(f);
    }
    // The range of the next search: to an end of the copies, or out of the cylinder about the fiber.
    void limit(const Fiber &f) {
        if (p.z < 0 || p.z > f.period) p.z -= f.period * std::floor(p.z / f.period); // into the middle copy
        float end = d.z > 0 ? f.high : f.low;
        far = d.z != 0 ? (end - p.z) / d.z : INFINITY;
        cut = true;
        if (!inside) {
            float a = d.x * d.x + d.y * d.y, b = p.x * d.x + p.y * d.y, c = p.x * p.x + p.y * p.y - 1.00001f;
            float root = b * b - a * c;
            float out = root > 0 && a > 0 ? (std::sqrt(root) - b) / a : 0;
            if (out <= far) {
                far = out;
                cut = false;
            }
        }
    }
    // What was found; whether the photon is done.
    bool met(const Fiber &f, unsigned prim, float t, Sums &sums) {
        sums.segments++;
        if (prim == RTC_INVALID_GEOMETRY_ID) {
            if (cut) { // go on from the end of the copies
                p = p + far * d;
                p.z = d.z > 0 ? 0 : f.period;
                near = 0;
                // Through a seam, or along the axis: it would fly for ever.
                if (!(p.x * p.x + p.y * p.y < 1.1f) || ++cuts > 10000) {
                    sums.lost++;
                    return true;
                }
                limit(f);
                return false;
            }
            if (inside) {
                sums.lost++;
                return true;
            }
            if (!entered && tries < 64) {
                enter(f);
                return false;
            }
            sums.escaped++;
            return true;
        }
        p = p + t * d;
        near = OFF;
        Vec n = f.normal[prim];
        float cos = -dot(d, n);
        bool in = cos > 0; // against the outward normal
        bool is_void = f.is_void[prim];
        // A search that began on the wrong side of a triangle: the single precision of the loop.
        if (is_void ? !inside || (!in && layers == 0) : in == inside || layers != 0) {
            sums.lost++;
            return true;
        }
        entered = true;
        if (is_void && layers != (in ? 0 : 1)) { // between overlapping bodies there is no boundary
            layers += in ? 1 : -1;
            limit(f);
            return false;
        }
        if (!inside && events >= f.max_events) {
            sums.truncated++;
            return true;
        }
        float from = is_void ? (in ? f.cortex : f.air) : (in ? 1.0f : f.cortex);
        float to = is_void ? (in ? f.air : f.cortex) : (in ? f.cortex : 1.0f);
        if (!in) {
            n = -1.0f * n;
            cos = -cos;
        }
        events++;
        sums.events++;
        float ratio = from / to, sin2 = (1 - cos * cos) * ratio * ratio;
        float cos_t = sin2 < 1 ? std::sqrt(1 - sin2) : 0;
        bool reflects = sin2 >= 1;
        float u = rng.uniform();
        if (!reflects) {
            float s = (from * cos - to * cos_t) / (from * cos + to * cos_t);
            float q = (to * cos - from * cos_t) / (to * cos + from * cos_t);
            reflects = 2 * u < s * s + q * q;
        }
        if (reflects) {
            d = unit(d + 2 * cos * n);
        } else {
            d = unit(ratio * d + (ratio * cos - cos_t) * n);
            if (is_void)
                layers += in ? 1 : -1;
            else
                inside = in;
        }
        if (inside && events >= f.max_events) {
            sums.truncated++;
            return true;
        }
        limit(f);
        return false;
    }
};

static Sums fly_single(const Fiber &f, uint64_t photons, uint64_t seed) {
    Sums sums;
#if RTC_VERSION_MAJOR < 4
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
#else
    RTCIntersectArguments arguments;
    rtcInitIntersectArguments(&arguments);
    arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;
#endif
    for (uint64_t i = 0; i < photons; i++) {
        Photon photon;
        photon.start(f, seed, i);
        for (;;) {
            RTCRayHit r;
            r.ray.org_x = photon.p.x;
            r.ray.org_y = photon.p.y;
            r.ray.org_z = photon.p.z;
            r.ray.tnear = photon.near;
            r.ray.dir_x = photon.d.x;
            r.ray.dir_y = photon.d.y;
            r.ray.dir_z = photon.d.z;
            r.ray.time = 0;
            r.ray.tfar = photon.far;
            r.ray.mask = ~0u;
            r.ray.flags = 0;
            r.hit.geomID = r.hit.primID = RTC_INVALID_GEOMETRY_ID;
#if RTC_VERSION_MAJOR < 4
            rtcIntersect1(f.scene, &context, &r);
#else
            rtcIntersect1(f.scene, &r, &arguments);
#endif
            unsigned prim = r.hit.geomID == RTC_INVALID_GEOMETRY_ID ? RTC_INVALID_GEOMETRY_ID : r.hit.primID;
            if (photon.met(f, prim, r.ray.tfar, sums)) break;
        }
    }
    return sums;
}

template <typename Packet, int N, typename Intersect>
static Sums fly_packets(const Fiber &f, uint64_t photons, uint64_t seed, Intersect intersect) {
    Sums sums;
    Photon photon[N];
    alignas(64) Packet r;
    alignas(64) int valid[N];
    uint64_t next = 0;
    int flying = 0;
    for (int i = 0; i < N; i++) {
        valid[i] = next < photons ? -1 : 0;
        if (valid[i]) photon[i].start(f, seed, next++), flying++;
    }
    while (flying) {
        for (int i = 0; i < N; i++) {
            const Photon &q = photon[i];
            r.ray.org_x[i] = q.p.x;
            r.ray.org_y[i] = q.p.y;
            r.ray.org_z[i] = q.p.z;
            r.ray.tnear[i] = q.near;
            r.ray.dir_x[i] = q.d.x;
            r.ray.dir_y[i] = q.d.y;
            r.ray.dir_z[i] = q.d.z;
            r.ray.time[i] = 0;
            r.ray.tfar[i] = q.far;
            r.ray.mask[i] = ~0u;
            r.ray.flags[i] = 0;
            r.hit.geomID[i] = r.hit.primID[i] = RTC_INVALID_GEOMETRY_ID;
        }
        intersect(valid, r);
        for (int i = 0; i < N; i++) {
            if (!valid[i]) continue;
            unsigned prim =
                r.hit.geomID[i] == RTC_INVALID_GEOMETRY_ID ? RTC_INVALID_GEOMETRY_ID : r.hit.primID[i];
            if (photon[i].met(f, prim, r.ray.tfar[i], sums)) {
                if (next < photons)
                    photon[i].start(f, seed, next++);
                else
                    valid[i] = 0, flying--;
            }
        }
    }
    return sums;
}

#if RTC_VERSION_MAJOR < 4
#define PACKETS(N)                                                                                           \
    fly_packets<RTCRayHit##N, N>(f, photons, seed, [&](const int *valid, RTCRayHit##N &r) {                  \
        RTCIntersectContext context;                                                                         \
        rtcInitIntersectContext(&context);                                                                   \
        context.flags = RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;                                               \
        rtcIntersect##N(valid, f.scene, &context, &r);                                                       \
    })
#else
#define PACKETS(N)                                                                                           \
    fly_packets<RTCRayHit##N, N>(f, photons, seed, [&](const int *valid, RTCRayHit##N &r) {                  \
        RTCIntersectArguments arguments;                                                                     \
        rtcInitIntersectArguments(&arguments);                                                               \
        arguments.flags = RTC_RAY_QUERY_FLAG_INCOHERENT;                                                     \
        rtcIntersect##N(valid, f.scene, &r, &arguments);                                                     \
    })
#endif

static double thread_seconds() {
    timespec t;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
    return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

int main(int argc, char **argv) {
    Fiber f = load(argc, argv);
    int width;
    uint64_t photons, seed;
    while (std::cin >> width >> photons >> seed) {
        double start = thread_seconds();
        Sums s = width == 1   ? fly_single(f, photons, seed)
                 : width == 4 ? PACKETS(4)
                 : width == 8 ? PACKETS(8)
                              : PACKETS(16);
        double seconds = thread_seconds() - start;
        std::printf("%.9f %llu %llu %llu %llu %llu\n", seconds, (unsigned long long)s.segments,
                    (unsigned long long)s.events, (unsigned long long)s.escaped, (unsigned long long)s.truncated,
                    (unsigned long long)s.lost);
        std::fflush(stdout);
    }
}
