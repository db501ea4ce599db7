// The exact waves of a marched scene: plain sphere tracing in `double` to 1e-12 m.
//
//   reference SCENE DIRECTIONS ITERATIONS ENDS    traces; ENDS gets four doubles per wave: a position and the
//                                                 status (0 heard, n at surface n, -1 lost)
//   reference SCENE ENDS OBJECTS                  reads four floats per wave (waves.h) and writes as a float
//                                                 the nearest surface of each wave, counted from 1
#include "waves.h"

#include <thread>

namespace {

constexpr double TOUCH = 1e-12; // metres
constexpr double START = 1e-10; // of a flight from a surface, metres
constexpr double AHEAD = 1e-7;  // of a point where the value must have fallen for a hit, metres
constexpr double PROBE = 1e-5;  // half the step of difference quotients, metres
constexpr double FAR = 1e4;
constexpr int STEPS = 200000;

using Exact = Point<double>;

struct End {
    double x, y, z, status;
};

Exact at(const Exact &p, const Exact &d, double t) { return {p.x + t * d.x, p.y + t * d.y, p.z + t * d.z}; }

double dot(const Exact &a, const Exact &b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

template <class Scene>
int nearestSurface(const Exact &p) {
    double values[Scene::SURFACES];
    Scene::values(p, values);
    return static_cast<int>(std::min_element(values, values + Scene::SURFACES) - values);
}

template <class Scene>
double valueOf(const Exact &p, int surface) {
    double values[Scene::SURFACES];
    Scene::values(p, values);
    return values[surface];
}

// The derivative along an axis, times 2 PROBE. Where the second derivative jumps at the surface, as it does for
// an ellipsoid's value, the error of a difference quotient is proportional to its step. The quotients of two
// steps are therefore extrapolated to a step of 0 (Richardson).
template <class Scene>
double difference(const Exact &p, int surface, const Exact &axis) {
    const auto over = [&](double step) {
        return valueOf<Scene>(at(p, axis, step), surface) - valueOf<Scene>(at(p, axis, -step), surface);
    };
    return 4 * over(0.5 * PROBE) - over(PROBE);
}

template <class Scene>
Exact normal(const Exact &p, int surface) {
    const Exact g{difference<Scene>(p, surface, {1, 0, 0}), difference<Scene>(p, surface, {0, 1, 0}),
                  difference<Scene>(p, surface, {0, 0, 1})};
    const double inverse = 1 / length(g);
    return {g.x * inverse, g.y * inverse, g.z * inverse};
}

// Moves `p` to the end of the flight, and returns the status there.
template <class Scene>
double fly(Exact &p, const Exact &d, double t) {
    for (int step = 0; step < STEPS && t < FAR; step++) {
        const Exact q = at(p, d, t);
        const double listener = listenerDistance<Scene>(q), surface = nearest<Scene>(q);
        const bool goesIn = surface <= TOUCH && nearest<Scene>(at(q, d, AHEAD)) < surface;
        if (listener <= TOUCH || goesIn) {
            p = q;
            return listener <= TOUCH ? 0 : nearestSurface<Scene>(q) + 1;
        }
        t += std::min(std::max(std::fabs(surface), TOUCH), listener);
    }
    return -1;
}

template <class Scene>
End trace(const FourFloats &start, uint32_t iterations) {
    Exact p{Scene::SOURCE.x, Scene::SOURCE.y, Scene::SOURCE.z}, d{start.x, start.y, start.z};
    const double inverse = 1 / length(d);
    d = {d.x * inverse, d.y * inverse, d.z * inverse};
    double status = 1;
    for (uint32_t iteration = 0; iteration < iterations; iteration++) {
        status = fly<Scene>(p, d, iteration ? START : 0);
        if (status < 1) {
            break;
        }
        const Exact n = normal<Scene>(p, static_cast<int>(status) - 1);
        d = at(d, n, -2 * dot(d, n));
    }
    return {p.x, p.y, p.z, status};
}

template <class Scene>
void traceAll(const std::vector<FourFloats> &starts, uint32_t iterations, const std::string &path) {
    std::vector<End> ends(starts.size());
    const unsigned threads = std::max(1u, std::thread::hardware_concurrency());
    std::vector<std::thread> running;
    for (unsigned thread = 0; thread < threads; thread++) {
        running.emplace_back([&, thread] {
            for (size_t wave = thread; wave < starts.size(); wave += threads) {
                ends[wave] = trace<Scene>(starts[wave], iterations);
            }
        });
    }
    for (std::thread &thread : running) {
        thread.join();
    }
    writeAll(path, ends);
}

template <class Scene>
void nameObjects(const std::vector<FourFloats> &ends, const std::string &path) {
    std::vector<float> objects;
    for (const FourFloats &end : ends) {
        objects.push_back(static_cast<float>(nearestSurface<Scene>({end.x, end.y, end.z}) + 1));
    }
    writeAll(path, objects);
}

} // namespace

int main(int count, char **values) {
    return guarded([&] {
        if (count != 4) {
            expectArguments(count, 5, values, "SCENE DIRECTIONS ITERATIONS ENDS, or SCENE ENDS OBJECTS");
        }
        const std::vector<FourFloats> waves = readAll<FourFloats>(values[2]);
        withScene(values[1], [&](auto scene) {
            using Scene = decltype(scene);
            if (count == 4) {
                nameObjects<Scene>(waves, values[3]);
            } else {
                traceAll<Scene>(waves, number(values[3], "iterations", 1), values[4]);
            }
        });
    });
}
