// The 60-line tracer (naive.glsl) in C++, eight waves in a register. It shows the speed of steps by the value
// on this processor.
#include "waves.h"

namespace {

constexpr float MIN_DISTANCE = 1e-3f;
constexpr float START = 0.02f;  // of each flight, metres
constexpr float OFFSET = 2e-3f; // along the normal, metres
constexpr float PROBE = 1e-3f;  // half the step of difference quotients, metres
constexpr float FAR = 300;
constexpr int STEPS = 400;

using Points = Point<Lanes>;

Points at(const Points &p, const Points &d, Lanes t) {
    return {fma(t, d.x, p.x), fma(t, d.y, p.y), fma(t, d.z, p.z)};
}

template <class Scene>
Points normal(const Points &p) {
    const auto along = [&](float x, float y, float z) {
        const Lanes3 step{x, y, z};
        return nearest<Scene>(Points{p.x + step.x, p.y + step.y, p.z + step.z}) -
               nearest<Scene>(Points{p.x - step.x, p.y - step.y, p.z - step.z});
    };
    const Points g{along(PROBE, 0, 0), along(0, PROBE, 0), along(0, 0, PROBE)};
    const Lanes inverse = Lanes(1.0f) / length(g);
    return {g.x * inverse, g.y * inverse, g.z * inverse};
}

// Steps until every wave has arrived; returns the lengths of the flights.
template <class Scene>
Lanes march(const Points &o, const Points &d, Lanes active, Lanes &heard) {
    Lanes t = START;
    heard = 0.0f;
    for (int step = 0; step < STEPS && bits(active); step++) {
        const Points p = at(o, d, t);
        const Lanes surface = nearest<Scene>(p), listener = listenerDistance<Scene>(p);
        const Lanes reached = active & (listener < MIN_DISTANCE);
        heard = heard | reached;
        active = andNot(reached | (surface < MIN_DISTANCE), active);
        t = t + (min(surface, listener) & active);
        active = active & (t < FAR);
    }
    return t;
}

template <class Scene>
void trace(const FourFloats *directions, uint32_t iterations, FourFloats *ends) {
    const Lanes3 start = loadEight(directions);
    Points d{start.x, start.y, start.z}, o{Scene::SOURCE.x, Scene::SOURCE.y, Scene::SOURCE.z}, end = o;
    Lanes status = TRAVELLING, travelling = allSet();
    for (uint32_t iteration = 0; iteration < iterations && bits(travelling); iteration++) {
        Lanes heard;
        const Points p = at(o, d, march<Scene>(o, d, travelling, heard));
        end = {select(travelling, p.x, end.x), select(travelling, p.y, end.y), select(travelling, p.z, end.z)};
        status = select(heard, HEARD, status);
        travelling = andNot(heard, travelling);
        const Points n = normal<Scene>(p);
        const Lanes twice = (d.x * n.x + d.y * n.y + d.z * n.z) * -2.0f;
        o = at(p, n, OFFSET);
        d = at(d, n, twice);
    }
    storeEight(ends, {end.x, end.y, end.z}, status);
}

} // namespace

int main(int count, char **values) {
    return guarded([&] {
        expectArguments(count, 6, values, "SCENE DIRECTIONS ITERATIONS FRAMES ENDS");
        withScene(values[1], [&](auto scene) { timeWaves(values, trace<decltype(scene)>); });
    });
}
