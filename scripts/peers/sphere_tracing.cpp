// Sphere tracing (Hart 1996) by a minimum distance of 1e-3 m, eight waves in a register.
//
// A wave steps by the distance to the nearest surface until that distance is below the minimum distance, and
// is mirrored there. So that a wave can leave a surface, only the walls of the room ahead of the wave count,
// and the convex box or pillar that mirrored the wave last is skipped. (A wave takes twice as many steps if
// it tests all surfaces and starts a little off the last surface.) The waves of a group step until all of
// them have arrived, then all are mirrored at once. Lanes that continued independently, with new waves in
// place of finished waves, were not faster: at almost every step some lane needs a reflection.
#include "directions.h"
#include "peer.h"

namespace {

// Packets that are traced together.
constexpr int PACKETS = 2;

constexpr float MIN_DISTANCE = 1e-3f;

struct Waves {
    Lanes3 position, direction;
    Lanes3 towards; // the sign of the direction
    Lanes3 reach;   // coordinate of the wall ahead, times that sign
    Lanes left;     // the box or pillar that mirrored it last, from 1; 0 for the room
    Lanes travelling;
};

// The distance to the nearest surface, and to the listener.
struct Nearest {
    Lanes distance;
    Lanes listener;
};

// A distance, or NaN (which `min` ignores) for the surface that the wave leaves.
inline Lanes unlessLeft(const Waves &w, int index, Lanes distance) {
    return distance | (w.left == static_cast<float>(index + 1));
}

inline Lanes unit(Lanes sign) { return Lanes(1.0f) | signOf(sign); }

// The walls ahead are the same until the wave is mirrored.
inline void lookAhead(const Scene &scene, Waves &w) {
    w.towards = {unit(w.direction.x), unit(w.direction.y), unit(w.direction.z)};
    const auto reach = [](Lanes towards, float size) { return max(towards, 0.0f) * size; };
    w.reach = {reach(w.towards.x, scene.room.x), reach(w.towards.y, scene.room.y),
               reach(w.towards.z, scene.room.z)};
}

inline Lanes3 wallDistances(const Waves &w) {
    return {fma(-w.position.x, w.towards.x, w.reach.x), fma(-w.position.y, w.towards.y, w.reach.y),
            fma(-w.position.z, w.towards.z, w.reach.z)};
}

inline Lanes3 boxOffset(const Box &box, const Lanes3 &p) {
    const auto axis = [](Lanes p, float low, float high) {
        return absolute(p - 0.5f * (low + high)) - 0.5f * (high - low);
    };
    return {axis(p.x, box.low.x, box.high.x), axis(p.y, box.low.y, box.high.y),
            axis(p.z, box.low.z, box.high.z)};
}

inline Lanes boxDistance(const Box &box, const Lanes3 &p) {
    const Lanes3 q = boxOffset(box, p);
    const Lanes3 outside{max(q.x, 0.0f), max(q.y, 0.0f), max(q.z, 0.0f)};
    const Lanes inside = min(max(max(q.x, q.y), q.z), 0.0f);
    return squareRoot(dot(outside, outside)) + inside;
}

inline Lanes pillarDistance(const Pillar &pillar, const Lanes3 &p) {
    const Lanes x = p.x - pillar.x, z = p.z - pillar.z;
    return squareRoot(fma(x, x, z * z)) - pillar.radius;
}

template <int BOXES, int PILLARS>
Nearest nearest(const Scene &scene, const Waves &w) {
    const Lanes3 walls = wallDistances(w);
    Lanes distance = min(min(walls.x, walls.y), walls.z);
    for (int box = 0; box < BOXES; box++) {
        distance = min(unlessLeft(w, box, boxDistance(scene.boxes[box], w.position)), distance);
    }
    for (int pillar = 0; pillar < PILLARS; pillar++) {
        const Lanes other = pillarDistance(scene.pillars[pillar], w.position);
        distance = min(unlessLeft(w, BOXES + pillar, other), distance);
    }
    const Vec3 c = scene.listener;
    const Lanes3 offset = w.position - Lanes3{c.x, c.y, c.z};
    return {distance, squareRoot(dot(offset, offset)) - scene.listenerRadius};
}

// Mask of the axis on which a value of three equals the given one.
inline Lanes3 axisOf(const Lanes3 &values, Lanes value) {
    const Lanes x = values.x == value, y = andNot(x, values.y == value);
    return {x, y, andNot(x | y, allSet())};
}

// Mirrors the waves at the nearest surface. The surface is searched again, because reflections are rare.
template <int BOXES, int PILLARS>
void mirror(const Scene &scene, Waves &w) {
    const Lanes3 p = w.position;
    const Lanes3 walls = wallDistances(w);
    Lanes distance = min(min(walls.x, walls.y), walls.z);
    Lanes3 n = axisOf(walls, distance) & Lanes(1.0f);
    Lanes left = 0.0f;
    const auto take = [&](int index, Lanes other, const Lanes3 &normal) {
        const Lanes nearer = unlessLeft(w, index, other) < distance;
        distance = select(nearer, other, distance);
        left = select(nearer, static_cast<float>(index + 1), left);
        n = select(nearer, normal, n);
    };
    for (int index = 0; index < BOXES; index++) {
        const Box &box = scene.boxes[index];
        const Lanes3 q = boxOffset(box, p);
        take(index, boxDistance(box, p), axisOf(q, max(max(q.x, q.y), q.z)) & Lanes(1.0f));
    }
    for (int index = 0; index < PILLARS; index++) {
        const Pillar &pillar = scene.pillars[index];
        const Lanes x = p.x - pillar.x, z = p.z - pillar.z;
        const Lanes inverse = Lanes(1.0f) / squareRoot(fma(x, x, z * z));
        take(BOXES + index, pillarDistance(pillar, p), {x * inverse, 0.0f, z * inverse});
    }
    // The sign of the normal does not matter here.
    w.direction = along(w.direction, n, dot(w.direction, n) * -2.0f);
    w.left = left;
    lookAhead(scene, w);
}

// Steps all waves to within the minimum distance of a surface or the listener; returns the mask of those that
// reached the listener.
template <int BOXES, int PILLARS>
void march(const Scene &scene, Waves (&waves)[PACKETS], Lanes (&heard)[PACKETS]) {
    Lanes stepping[PACKETS];
    for (int packet = 0; packet < PACKETS; packet++) {
        stepping[packet] = waves[packet].travelling;
        heard[packet] = 0.0f;
    }
    int left = 1;
    while (left) {
        left = 0;
        for (int packet = 0; packet < PACKETS; packet++) {
            Waves &w = waves[packet];
            const Nearest near = nearest<BOXES, PILLARS>(scene, w);
            const Lanes distance = min(near.distance, near.listener);
            const Lanes arrived = stepping[packet] & (distance < MIN_DISTANCE);
            heard[packet] = heard[packet] | (arrived & (near.listener <= near.distance));
            stepping[packet] = andNot(arrived, stepping[packet]);
            w.position = along(w.position, w.direction, distance & stepping[packet]);
            left |= bits(stepping[packet]);
        }
    }
}

// The listener looks along -z; x points to its right ear.
void hear(const Scene &scene, const Waves &w, Lanes heard, uint32_t order, Result &result) {
    const Lanes side = (w.position.x - scene.listener.x) / (scene.listenerRadius + MIN_DISTANCE);
    const Lanes right = fma(side, 0.5f, 0.5f);
    result.hits[order] += static_cast<uint64_t>(count(heard));
    result.right += sum(right & heard);
    result.left += sum((1.0f - right) & heard);
}

template <int BOXES, int PILLARS>
Result trace(const Scene &scene, const Lattice &lattice, uint32_t iterations) {
    Result result(iterations);
    const Vec3 s = scene.source;
    for (uint32_t first = 0; first < lattice.waves; first += 8 * PACKETS) {
        Waves waves[PACKETS];
        for (int packet = 0; packet < PACKETS; packet++) {
            waves[packet].position = {s.x, s.y, s.z};
            waves[packet].direction = lattice.directions(first + 8 * packet);
            waves[packet].travelling = allSet();
            lookAhead(scene, waves[packet]);
        }
        for (uint32_t order = 0; order < iterations; order++) {
            Lanes heard[PACKETS];
            march<BOXES, PILLARS>(scene, waves, heard);
            for (int packet = 0; packet < PACKETS; packet++) {
                Waves &w = waves[packet];
                if (bits(heard[packet])) {
                    hear(scene, w, heard[packet], order, result);
                    w.travelling = andNot(heard[packet], w.travelling);
                }
                mirror<BOXES, PILLARS>(scene, w);
            }
        }
    }
    return result;
}

template <int BOXES, int PILLARS>
void time(const Arguments &arguments, const Lattice &lattice) {
    timeFrames(arguments.frames,
               [&] { return trace<BOXES, PILLARS>(arguments.scene, lattice, arguments.iterations); });
}

} // namespace

int main(int count, char **values) {
    return guarded([&] {
        const Arguments arguments = readArguments(count, values);
        const Scene &scene = arguments.scene;
        const Lattice lattice(scene, arguments.waves);
        if (scene.boxes.empty() && scene.pillars.empty()) {
            time<0, 0>(arguments, lattice);
        } else if (scene.boxes.size() == 2 && scene.pillars.size() == 3) {
            time<2, 3>(arguments, lattice);
        } else {
            throw std::runtime_error("sphere tracing is compiled for the scenes A and B alone");
        }
    });
}
