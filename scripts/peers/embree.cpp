// Embree 3, a ray tracer used by many programs, with packets of 16 rays (rtcIntersect16).
//
//   embree SCENE.txt WAVES ITERATIONS FRAMES [PILLARS]
//
// Walls and boxes are quads. PILLARS chooses the geometry of pillars:
//   user    user geometry: a callback solves for the circle, eight rays at a time (the default, because
//           it is the fastest and exact)
//   prism   quads around a prism of 32 sides, of the same area as the circle: about as fast as `user`
//   curve   Embree's own cylinders (cone-linear curves): about half as fast with three pillars
// The listener is a closed form outside Embree, eight rays at a time, because it does not mirror rays.
// A mirrored ray starts 0.1 mm off its surface, on the side of the incoming ray.
#include "directions.h"
#include "peer.h"

#include <cmath>
#include <embree3/rtcore.h>
#include <limits>
#include <memory>

namespace {

constexpr int PACKET = 16;
constexpr float START_OFFSET = 1e-4f;
constexpr int SIDES = 32;
constexpr float PI = 3.14159265f;

// A quad's four corners: Embree takes indices.
struct Quads {
    std::vector<Vec3> vertices;

    void add(Vec3 a, Vec3 b, Vec3 c, Vec3 d) { vertices.insert(vertices.end(), {a, b, c, d}); }

    // The six faces of a box.
    void addBox(Vec3 low, Vec3 high) {
        const auto corner = [&](int bits) {
            return Vec3{bits & 1 ? high.x : low.x, bits & 2 ? high.y : low.y, bits & 4 ? high.z : low.z};
        };
        const int faces[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                 {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
        for (const auto &face : faces) {
            add(corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3]));
        }
    }

    void addPrism(const Pillar &pillar, float height) {
        // A regular polygon of the circle's area.
        const float step = 2 * PI / SIDES;
        const float radius = pillar.radius * std::sqrt(step / std::sin(step));
        const auto corner = [&](int side, float y) {
            const float angle = step * static_cast<float>(side);
            return Vec3{pillar.x + radius * std::cos(angle), y, pillar.z + radius * std::sin(angle)};
        };
        for (int side = 0; side < SIDES; side++) {
            add(corner(side, 0), corner(side + 1, 0), corner(side + 1, height), corner(side, height));
        }
    }
};

template <typename T>
T *buffer(RTCGeometry geometry, RTCBufferType type, RTCFormat format, size_t stride, size_t count) {
    return static_cast<T *>(rtcSetNewGeometryBuffer(geometry, type, 0, format, stride, count));
}

void attach(RTCScene scene, RTCGeometry geometry) {
    rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
}

void attachQuads(RTCDevice device, RTCScene scene, const Quads &quads) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    const size_t count = quads.vertices.size();
    auto *vertices = buffer<Vec3>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, sizeof(Vec3), count);
    auto *indices = buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT4, 16, count / 4);
    for (size_t i = 0; i < count; i++) {
        vertices[i] = quads.vertices[i];
        indices[i] = static_cast<uint32_t>(i);
    }
    attach(scene, geometry);
}

void attachCurves(RTCDevice device, RTCScene scene, const Scene &told) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_CONE_LINEAR_CURVE);
    const size_t count = told.pillars.size();
    struct Vertex {
        float x, y, z, radius;
    };
    auto *vertices =
        buffer<Vertex>(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, sizeof(Vertex), 2 * count);
    auto *indices = buffer<uint32_t>(geometry, RTC_BUFFER_TYPE_INDEX, RTC_FORMAT_UINT, 4, count);
    for (size_t i = 0; i < count; i++) {
        const Pillar &pillar = told.pillars[i];
        // The pillar extends a little beyond floor and ceiling, so that no ray hits its ends.
        vertices[2 * i] = {pillar.x, -1, pillar.z, pillar.radius};
        vertices[2 * i + 1] = {pillar.x, told.room.y + 1, pillar.z, pillar.radius};
        indices[i] = static_cast<uint32_t>(2 * i);
    }
    attach(scene, geometry);
}

void pillarBounds(const RTCBoundsFunctionArguments *arguments) {
    const auto &told = *static_cast<const Scene *>(arguments->geometryUserPtr);
    const Pillar &pillar = told.pillars[arguments->primID];
    RTCBounds &bounds = *arguments->bounds_o;
    bounds.lower_x = pillar.x - pillar.radius;
    bounds.upper_x = pillar.x + pillar.radius;
    bounds.lower_y = 0;
    bounds.upper_y = told.room.y;
    bounds.lower_z = pillar.z - pillar.radius;
    bounds.upper_z = pillar.z + pillar.radius;
}

void storeWhere(Lanes mask, float *values, Lanes value) {
    _mm256_maskstore_ps(values, _mm256_castps_si256(mask.v), value.v);
}

void storeWhere(Lanes mask, unsigned *values, unsigned value) {
    _mm256_maskstore_epi32(reinterpret_cast<int *>(values), _mm256_castps_si256(mask.v),
                           _mm256_set1_epi32(static_cast<int>(value)));
}

Lanes load(const float *values) { return _mm256_loadu_ps(values); }

// Eight rays of a packet against a circle in the plane.
void intersectEight(const RTCIntersectFunctionNArguments &arguments, const Pillar &pillar, unsigned at) {
    RTCRayN *ray = RTCRayHitN_RayN(arguments.rayhit, arguments.N);
    RTCHitN *hit = RTCRayHitN_HitN(arguments.rayhit, arguments.N);
    const unsigned n = arguments.N;
    const Lanes dx = load(&RTCRayN_dir_x(ray, n, at)), dz = load(&RTCRayN_dir_z(ray, n, at));
    const Lanes x = load(&RTCRayN_org_x(ray, n, at)) - pillar.x,
                z = load(&RTCRayN_org_z(ray, n, at)) - pillar.z;
    const Lanes a = fma(dx, dx, dz * dz);
    const Lanes b = fma(x, dx, z * dz);
    const Lanes c = fma(x, x, fma(z, z, -pillar.radius * pillar.radius));
    const Lanes t = (-b - squareRoot(fma(b, b, -(a * c)))) / a;
    const __m256i valid = _mm256_loadu_si256(reinterpret_cast<const __m256i *>(arguments.valid + at));
    const Lanes met = Lanes(_mm256_castsi256_ps(valid)) & (t > load(&RTCRayN_tnear(ray, n, at))) &
                      (t < load(&RTCRayN_tfar(ray, n, at)));
    if (!bits(met)) {
        return;
    }
    storeWhere(met, &RTCRayN_tfar(ray, n, at), t);
    storeWhere(met, &RTCHitN_Ng_x(hit, n, at), fma(t, dx, x));
    storeWhere(met, &RTCHitN_Ng_y(hit, n, at), 0.0f);
    storeWhere(met, &RTCHitN_Ng_z(hit, n, at), fma(t, dz, z));
    storeWhere(met, &RTCHitN_geomID(hit, n, at), arguments.geomID);
    storeWhere(met, &RTCHitN_primID(hit, n, at), arguments.primID);
}

void intersectPillar(const RTCIntersectFunctionNArguments *arguments) {
    const auto &told = *static_cast<const Scene *>(arguments->geometryUserPtr);
    for (unsigned at = 0; at + 8 <= arguments->N; at += 8) {
        intersectEight(*arguments, told.pillars[arguments->primID], at);
    }
}

void attachUserPillars(RTCDevice device, RTCScene scene, const Scene &told) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, static_cast<unsigned>(told.pillars.size()));
    rtcSetGeometryUserData(geometry, const_cast<Scene *>(&told));
    rtcSetGeometryBoundsFunction(
        geometry, [](const RTCBoundsFunctionArguments *a) { pillarBounds(a); }, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersectPillar);
    attach(scene, geometry);
}

RTCScene build(RTCDevice device, const Scene &told, const std::string &pillars) {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
    Quads quads;
    quads.addBox({0, 0, 0}, told.room);
    for (const Box &box : told.boxes) {
        quads.addBox(box.low, box.high);
    }
    if (pillars == "prism") {
        for (const Pillar &pillar : told.pillars) {
            quads.addPrism(pillar, told.room.y);
        }
    } else if (pillars == "curve" && !told.pillars.empty()) {
        attachCurves(device, scene, told);
    } else if (pillars == "user" && !told.pillars.empty()) {
        attachUserPillars(device, scene, told);
    } else if (!told.pillars.empty()) {
        throw std::runtime_error("pillars are curve, user or prism, not " + pillars);
    }
    attachQuads(device, scene, quads);
    rtcCommitScene(scene);
    return scene;
}

// Sixteen waves in flight.
class Packet {
  public:
    Packet(RTCScene scene, const Scene &told) : scene(scene), told(told) {
        rtcInitIntersectContext(&context);
    }

    void trace(const Lattice &lattice, uint32_t first, uint32_t iterations, Result &result) {
        start(lattice, first);
        for (uint32_t order = 0; order < iterations; order++) {
            for (int lane = 0; lane < PACKET; lane++) {
                hits.ray.tnear[lane] = 0;
                hits.ray.tfar[lane] = std::numeric_limits<float>::infinity();
                hits.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
                hits.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
            }
            rtcIntersect16(travelling, scene, &context, &hits);
            const int left = goOn(0, order, result) | goOn(8, order, result);
            if (!left) {
                return;
            }
        }
    }

  private:
    void start(const Lattice &lattice, uint32_t first) {
        for (int at = 0; at < PACKET; at += 8) {
            const Lanes3 d = lattice.directions(first + static_cast<uint32_t>(at));
            const Vec3 s = told.source;
            store(at, {s.x, s.y, s.z}, d);
            _mm256_store_ps(reinterpret_cast<float *>(travelling + at), allSet().v);
        }
        for (int lane = 0; lane < PACKET; lane++) {
            hits.ray.time[lane] = 0;
            hits.ray.mask[lane] = ~0u;
            hits.ray.flags[lane] = 0;
        }
    }

    void store(int at, const Lanes3 &p, const Lanes3 &d) {
        RTCRay16 &ray = hits.ray;
        _mm256_store_ps(ray.org_x + at, p.x.v);
        _mm256_store_ps(ray.org_y + at, p.y.v);
        _mm256_store_ps(ray.org_z + at, p.z.v);
        _mm256_store_ps(ray.dir_x + at, d.x.v);
        _mm256_store_ps(ray.dir_y + at, d.y.v);
        _mm256_store_ps(ray.dir_z + at, d.z.v);
    }

    // Counts or mirrors eight of the waves; returns the mask of those that continue.
    int goOn(int at, uint32_t order, Result &result) {
        const RTCRay16 &ray = hits.ray;
        const Lanes3 p{load(ray.org_x + at), load(ray.org_y + at), load(ray.org_z + at)};
        const Lanes3 d{load(ray.dir_x + at), load(ray.dir_y + at), load(ray.dir_z + at)};
        const Lanes distance = load(ray.tfar + at);
        Lanes going = load(reinterpret_cast<const float *>(travelling + at));
        going = going & (distance < std::numeric_limits<float>::infinity());
        going = andNot(hear(p, d, distance, going, order, result), going);
        _mm256_store_ps(reinterpret_cast<float *>(travelling + at), going.v);

        // The normal on the side of the incoming ray, not normalised.
        Lanes3 n{load(hits.hit.Ng_x + at), load(hits.hit.Ng_y + at), load(hits.hit.Ng_z + at)};
        const Lanes along_n = dot(d, n);
        const Lanes square = dot(n, n);
        const Lanes scale = along_n * -2.0f / square;
        const Lanes off = (START_OFFSET / squareRoot(square)) ^ signOf(-along_n);
        store(at, along(along(p, d, distance), n, off), along(d, n, scale));
        return bits(going);
    }

    // The listener looks along -z; x points to its right ear.
    Lanes hear(const Lanes3 &p, const Lanes3 &d, Lanes distance, Lanes going, uint32_t order,
               Result &result) const {
        const Vec3 c = told.listener;
        const Lanes3 offset = p - Lanes3{c.x, c.y, c.z};
        const Lanes b = dot(offset, d);
        const Lanes rest = dot(offset, offset) - told.listenerRadius * told.listenerRadius;
        const Lanes t = -b - squareRoot(fma(b, b, -rest));
        const Lanes heard = going & (t > 0.0f) & (t < distance);
        if (!bits(heard)) {
            return heard;
        }
        const Lanes side = (fma(t, d.x, p.x) - c.x) / told.listenerRadius;
        const Lanes right = fma(side, 0.5f, 0.5f);
        result.hits[order] += static_cast<uint64_t>(count(heard));
        result.right += sum(right & heard);
        result.left += sum((1.0f - right) & heard);
        return heard;
    }

    RTCScene scene;
    const Scene &told;
    RTCIntersectContext context;
    alignas(64) RTCRayHit16 hits;
    alignas(64) int travelling[PACKET];
};

} // namespace

int main(int count, char **values) {
    return guarded([&] {
        const Arguments arguments = readArguments(count, values);
        const std::string pillars = count > 5 ? values[5] : "user";
        RTCDevice device = rtcNewDevice("threads=1,set_affinity=0");
        RTCScene scene = build(device, arguments.scene, pillars);
        const Lattice lattice(arguments.scene, arguments.waves);
        Packet packet(scene, arguments.scene);
        timeFrames(arguments.frames, [&] {
            Result result(arguments.iterations);
            for (uint32_t first = 0; first < lattice.waves; first += PACKET) {
                packet.trace(lattice, first, arguments.iterations, result);
            }
            return result;
        });
        rtcReleaseScene(scene);
        rtcReleaseDevice(device);
    });
}
