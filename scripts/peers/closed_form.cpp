// The closed form, eight waves in a register: the maximum speed of this processor with AVX2 for a room,
// axis-aligned boxes and pillars.
//
// All iterations of a group of waves are done in registers; only sums are stored. The numbers of boxes and
// pillars are known to the compiler. Two packets of eight are interleaved, so that one packet is calculated
// while the other packet waits for its results.
//
// Only the distance of each surface is kept; a miss is NaN, which `min` ignores. The face or pillar that was
// hit is found afterwards by comparing distances. A reflection at a face changes one sign of the direction,
// and the same sign of its inverse. The surface that a wave leaves lies behind the wave, at a distance that
// is not positive, so it needs no special case.
#include "directions.h"
#include "peer.h"

namespace {

// Packets that are traced together.
constexpr int PACKETS = 2;

struct Waves {
    Lanes3 position; // from the middle of the room
    Lanes3 direction;
    Lanes3 inverse; // 1 / direction
    Lanes3 reach;   // half of the room over |direction|
    Lanes inverseA; // 1 / (dx^2 + dz^2): a reflection at a wall or a pillar keeps it
    Lanes travelling;
};

// A box as slabs, by its middle and half its size.
struct Slabs {
    Vec3 middle, half;
};

struct Plan {
    Vec3 half; // of the room
    Vec3 source, listener;
    float listenerRadius;
    std::vector<Slabs> boxes;
    std::vector<Pillar> pillars;
};

Vec3 minus(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

// The scene relative to the middle of the room.
Plan planOf(const Scene &scene) {
    const Vec3 middle{0.5f * scene.room.x, 0.5f * scene.room.y, 0.5f * scene.room.z};
    Plan plan{middle, minus(scene.source, middle), minus(scene.listener, middle), scene.listenerRadius, {},
              {}};
    for (const Box &box : scene.boxes) {
        const Vec3 size = minus(box.high, box.low);
        const Vec3 half{0.5f * size.x, 0.5f * size.y, 0.5f * size.z};
        const Vec3 low = minus(box.low, middle);
        plan.boxes.push_back({{low.x + half.x, low.y + half.y, low.z + half.z}, half});
    }
    for (const Pillar &pillar : scene.pillars) {
        plan.pillars.push_back({pillar.x - middle.x, pillar.z - middle.z, pillar.radius});
    }
    return plan;
}

// The distance, or NaN where the mask is set.
inline Lanes unless(Lanes mask, Lanes distance) { return distance | mask; }

// The wall ahead of each pair of walls.
inline Lanes3 wallDistances(const Waves &w) {
    return {fma(-w.position.x, w.inverse.x, w.reach.x), fma(-w.position.y, w.inverse.y, w.reach.y),
            fma(-w.position.z, w.inverse.z, w.reach.z)};
}

// Distances at which the line enters the three slabs, and the box.
inline Lanes hitBox(const Slabs &box, const Waves &w, Lanes3 &enter) {
    const auto slab = [](Lanes p, Lanes inverse, float middle, float half, Lanes &enter, Lanes &leave) {
        const Lanes at = (middle - p) * inverse;
        const Lanes reach = absolute(inverse) * half;
        enter = at - reach;
        leave = at + reach;
    };
    Lanes3 leave;
    slab(w.position.x, w.inverse.x, box.middle.x, box.half.x, enter.x, leave.x);
    slab(w.position.y, w.inverse.y, box.middle.y, box.half.y, enter.y, leave.y);
    slab(w.position.z, w.inverse.z, box.middle.z, box.half.z, enter.z, leave.z);
    const Lanes in = max(max(enter.x, enter.y), enter.z);
    const Lanes out = min(min(leave.x, leave.y), leave.z);
    return unless((out <= in) | (in <= 0.0f), in);
}

// A circle in the plane. For a miss the result is NaN, the root of a negative number.
inline Lanes hitPillar(const Pillar &pillar, const Waves &w) {
    const Lanes x = w.position.x - pillar.x, z = w.position.z - pillar.z;
    const Lanes b = fma(x, w.direction.x, z * w.direction.z) * w.inverseA;
    const Lanes across = fma(x, w.direction.z, -(z * w.direction.x));
    const Lanes inside = fma(-across * w.inverseA, across, pillar.radius * pillar.radius);
    const Lanes t = -b - squareRoot(inside * w.inverseA);
    return unless(t <= 0.0f, t);
}

// Adds an arrival: the listener looks along -z; x points to its right ear.
void hear(const Plan &plan, const Waves &w, Lanes heard, Lanes t, uint32_t order, Result &result) {
    const Lanes arrival = fma(t, w.direction.x, w.position.x);
    const Lanes side = (arrival - plan.listener.x) / plan.listenerRadius;
    const Lanes right = fma(side, 0.5f, 0.5f);
    result.hits[order] += static_cast<uint64_t>(count(heard));
    result.right += sum(right & heard);
    result.left += sum((1.0f - right) & heard);
}

// Few lines meet the listener, and only these need the distance to it.
inline void listen(const Plan &plan, Waves &w, Lanes distance, uint32_t order, Result &result) {
    const Vec3 c = plan.listener;
    const Lanes3 offset = w.position - Lanes3{c.x, c.y, c.z};
    const Lanes b = dot(offset, w.direction);
    const Lanes rest = dot(offset, offset) - plan.listenerRadius * plan.listenerRadius;
    const Lanes discriminant = fma(b, b, -rest);
    const Lanes meets = (discriminant > 0.0f) & (b < 0.0f) & w.travelling;
    if (!bits(meets)) {
        return;
    }
    const Lanes t = -b - squareRoot(max(discriminant, 0.0f));
    const Lanes heard = meets & (t < distance);
    hear(plan, w, heard, t, order, result);
    w.travelling = andNot(heard, w.travelling);
}

inline Lanes mirrored(Lanes value, Lanes isAxis) { return value ^ (isAxis & Lanes(-0.0f)); }

inline void setDirection(const Plan &plan, Waves &w) {
    w.inverse = {Lanes(1.0f) / w.direction.x, Lanes(1.0f) / w.direction.y, Lanes(1.0f) / w.direction.z};
    w.reach = {absolute(w.inverse.x) * plan.half.x, absolute(w.inverse.y) * plan.half.y,
               absolute(w.inverse.z) * plan.half.z};
}

// Mirrors the waves that hit a pillar, at their hit points. The other waves have no pillar axis.
template <int PILLARS>
void mirrorAtPillars(const Plan &plan, const Lanes (&distances)[PILLARS + 1], Lanes distance, Waves &w) {
    Lanes centreX, centreZ, scale;
    for (int index = 0; index < PILLARS; index++) {
        const Pillar &pillar = plan.pillars[index];
        const Lanes met = distances[index] == distance;
        centreX = centreX | (met & pillar.x);
        centreZ = centreZ | (met & pillar.z);
        scale = scale | (met & (2.0f / (pillar.radius * pillar.radius)));
    }
    const Lanes x = w.position.x - centreX, z = w.position.z - centreZ;
    scale = scale * fma(w.direction.x, x, w.direction.z * z);
    w.direction.x = fma(-scale, x, w.direction.x);
    w.direction.z = fma(-scale, z, w.direction.z);
    setDirection(plan, w);
}

template <int BOXES, int PILLARS>
void iterate(const Plan &plan, Waves &w, uint32_t order, Result &result) {
    const Lanes3 walls = wallDistances(w);
    Lanes distance = min(min(walls.x, walls.y), walls.z);
    Lanes3 enter[BOXES + 1];
    for (int box = 0; box < BOXES; box++) {
        distance = min(hitBox(plan.boxes[box], w, enter[box]), distance);
    }
    Lanes pillars[PILLARS + 1];
    Lanes nearest = distance;
    for (int pillar = 0; pillar < PILLARS; pillar++) {
        pillars[pillar] = hitPillar(plan.pillars[pillar], w);
        nearest = min(pillars[pillar], nearest);
    }
    listen(plan, w, nearest, order, result);

    Lanes isX = walls.x == nearest, isY = walls.y == nearest, isZ = walls.z == nearest;
    for (int box = 0; box < BOXES; box++) {
        isX = isX | (enter[box].x == nearest);
        isY = isY | (enter[box].y == nearest);
        isZ = isZ | (enter[box].z == nearest);
    }
    w.position = along(w.position, w.direction, nearest);
    w.direction = {mirrored(w.direction.x, isX), mirrored(w.direction.y, isY), mirrored(w.direction.z, isZ)};
    w.inverse = {mirrored(w.inverse.x, isX), mirrored(w.inverse.y, isY), mirrored(w.inverse.z, isZ)};
    if (PILLARS > 0 && bits(nearest < distance)) {
        mirrorAtPillars<PILLARS>(plan, pillars, nearest, w);
    }
}

inline Waves start(const Plan &plan, const Lanes3 &directions) {
    const Vec3 s = plan.source;
    Waves w;
    w.position = {s.x, s.y, s.z};
    w.direction = directions;
    setDirection(plan, w);
    w.inverseA = Lanes(1.0f) / fma(directions.x, directions.x, directions.z * directions.z);
    w.travelling = allSet();
    return w;
}

template <int BOXES, int PILLARS>
Result trace(const Plan &plan, const Lattice &lattice, uint32_t iterations) {
    Result result(iterations);
    for (uint32_t first = 0; first < lattice.waves; first += 8 * PACKETS) {
        Waves waves[PACKETS];
        for (int packet = 0; packet < PACKETS; packet++) {
            waves[packet] = start(plan, lattice.directions(first + 8 * packet));
        }
        for (uint32_t order = 0; order < iterations; order++) {
            for (Waves &packet : waves) {
                iterate<BOXES, PILLARS>(plan, packet, order, result);
            }
        }
    }
    return result;
}

template <int BOXES, int PILLARS>
void time(const Arguments &arguments) {
    const Plan plan = planOf(arguments.scene);
    const Lattice lattice(arguments.scene, arguments.waves);
    timeFrames(arguments.frames, [&] { return trace<BOXES, PILLARS>(plan, lattice, arguments.iterations); });
}

} // namespace

int main(int count, char **values) {
    return guarded([&] {
        const Arguments arguments = readArguments(count, values);
        const Scene &scene = arguments.scene;
        if (scene.boxes.empty() && scene.pillars.empty()) {
            time<0, 0>(arguments);
        } else if (scene.boxes.size() == 2 && scene.pillars.size() == 3) {
            time<2, 3>(arguments);
        } else {
            throw std::runtime_error("the closed form is compiled for the scenes A and B alone");
        }
    });
}
