// The scenes with marched fields, as distance functions of one point (`double`) or of eight (`Lanes`).
//
// A scene is a struct with the positions of source and listener, the number of its surfaces, and
// `values`: lower bounds of the distances to all its surfaces. Lengths are in metres. Constants have the
// precision of the scene files' numbers (float), so that both types describe the same surfaces.
#pragma once

#include "../directions.h"
#include "../lanes.h"
#include "../scene.h"

#include <algorithm>
#include <cmath>

inline double min(double a, double b) { return std::min(a, b); }
inline double max(double a, double b) { return std::max(a, b); }
inline double absolute(double a) { return std::fabs(a); }
inline double squareRoot(double a) { return std::sqrt(a); }
inline double roundDown(double a) { return std::floor(a); }

template <class Number>
struct Point {
    Number x, y, z;
};

template <class Number>
Point<Number> operator-(const Point<Number> &p, Vec3 c) {
    return {p.x - Number(c.x), p.y - Number(c.y), p.z - Number(c.z)};
}

template <class Number>
Number length(Number x, Number y) {
    return squareRoot(x * x + y * y);
}

template <class Number>
Number length(const Point<Number> &p) {
    return squareRoot(p.x * p.x + p.y * p.y + p.z * p.z);
}

template <class Number>
Number clamp(Number value, float least, float most) {
    return min(max(value, Number(least)), Number(most));
}

template <class Number>
Number boxDistance(const Point<Number> &p, Vec3 half) {
    const Number x = absolute(p.x) - half.x, y = absolute(p.y) - half.y, z = absolute(p.z) - half.z;
    const Point<Number> outside{max(x, Number(0.0f)), max(y, Number(0.0f)), max(z, Number(0.0f))};
    return length(outside) + min(max(x, max(y, z)), Number(0.0f));
}

// A user's field: its value divided by its Lipschitz constant, limited to its box.
template <class Number>
Number cutOff(Number value, float growth, const Point<Number> &p, Vec3 half) {
    return max(value / Number(growth), boxDistance(p, half));
}

// ---- the built-in scene `cave` (examples/scenes/cave.ron)

struct Cave {
    static constexpr Vec3 SOURCE{-8, -0.5f, -1.5f};
    static constexpr Vec3 LISTENER{6, 0, -2};
    static constexpr float LISTENER_RADIUS = 1;
    static constexpr int SURFACES = 4;

    // The parts of the air.
    static constexpr Vec3 EGG{-7, 0, 0}, EGG_RADII{5.5f, 4, 5};
    static constexpr Vec3 HALL{6, 0.5f, -3}, NICHE{9, 0, 1};
    static constexpr float HALL_RADIUS = 4, NICHE_RADIUS = 2.5f;
    // The passage lies along x: the scene file's rotation turns the capsule's axis there.
    static constexpr float PASSAGE_RADIUS = 1.8f, PASSAGE_HALF = 6;
    // Radius of the rounding where two parts meet.
    static constexpr float ROUNDED = 2;
    // The stones: a cone that stands, a cone that hangs, and a boulder.
    static constexpr Vec3 STANDING{-5, -2.2f, -2}, HANGING{-8, 2.2f, 1.5f};
    static constexpr float STANDING_RADIUS = 0.9f, HANGING_RADIUS = 0.7f, CONE_HALF = 2;
    static constexpr Vec3 BOULDER{5, -2.7f, -4}, BOULDER_RADII{1, 0.7f, 0.8f};

    // Echomarch's value of an ellipsoid: F / |grad F|, with a term that keeps the value below the distance.
    template <class Number>
    static Number ellipsoid(const Point<Number> &p, Vec3 radii) {
        const Number a = Number(1.0f) / (Number(radii.x) * Number(radii.x));
        const Number b = Number(1.0f) / (Number(radii.y) * Number(radii.y));
        const Number c = Number(1.0f) / (Number(radii.z) * Number(radii.z));
        const Number F = a * p.x * p.x + b * p.y * p.y + c * p.z * p.z - Number(1.0f);
        const Number g = length(Point<Number>{a * p.x, b * p.y, c * p.z}) * Number(2.0f);
        const Number root = squareRoot(g * g + Number(4.0f) * max(a, max(b, c)) * absolute(F));
        return Number(2.0f) * F / max(g + root, Number(1e-30f));
    }

    // The union with a fillet: Quilez' quadratic smooth minimum.
    template <class Number>
    static Number rounded(Number a, Number b) {
        const Number h = max(Number(ROUNDED) - absolute(a - b), Number(0.0f));
        return min(a, b) - h * h * Number(0.25f / ROUNDED);
    }

    template <class Number>
    static Number rock(const Point<Number> &p) {
        const Number along = p.x - clamp(p.x, -PASSAGE_HALF, PASSAGE_HALF);
        Number air = rounded(ellipsoid(p - EGG, EGG_RADII), length(p - HALL) - Number(HALL_RADIUS));
        air = rounded(air, length(p - NICHE) - Number(NICHE_RADIUS));
        air = rounded(air, length(Point<Number>{along, p.y, p.z}) - Number(PASSAGE_RADIUS));
        return -air;
    }

    // A cone about y with its apex up, from the distances to the line segments of its outline.
    template <class Number>
    static Number cone(const Point<Number> &p, float radius, float half) {
        const float slant = std::sqrt(4 * half * half + radius * radius);
        const float sideX = 2 * half / slant, sideY = radius / slant;
        const Number out = length(p.x, p.z) - Number(radius), up = p.y + Number(half);
        const Number base = length(max(out, Number(0.0f)), up);
        // Along the side from the edge to the apex, and across it.
        const Number along = up * Number(sideX) - out * Number(sideY);
        const Number across = out * Number(sideX) + up * Number(sideY);
        const Number side = length(across, along - clamp(along, 0, slant));
        const Number within = max(across, -up);
        const Number outline = min(base, side);
        return max(min(outline, within * Number(1e30f)), -outline);
    }

    template <class Number>
    static void values(const Point<Number> &p, Number (&value)[SURFACES]) {
        const Point<Number> hanging = p - HANGING;
        value[0] = rock(p);
        value[1] = cone(p - STANDING, STANDING_RADIUS, CONE_HALF);
        value[2] = cone(Point<Number>{hanging.x, -hanging.y, hanging.z}, HANGING_RADIUS, CONE_HALF);
        value[3] = ellipsoid(p - BOULDER, BOULDER_RADII);
    }
};

// ---- gyroid.ron

// Sine and cosine of an angle in radians.
inline void sineAndCosineOf(double angle, double &sine, double &cosine) {
    sine = std::sin(angle);
    cosine = std::cos(angle);
}

inline void sineAndCosineOf(Lanes angle, Lanes &sine, Lanes &cosine) {
    const Lanes turns = angle * 0.15915494309f;
    sineAndCosine(turns - roundDown(turns), sine, cosine);
}

struct Gyroid {
    static constexpr Vec3 SOURCE{-7, 1, -6};
    static constexpr Vec3 LISTENER{7.5f, 1, 6.5f};
    static constexpr float LISTENER_RADIUS = 1;
    static constexpr int SURFACES = 2;

    template <class Number>
    static Number field(const Point<Number> &p) {
        const Number scale = Number(1.25f);
        Point<Number> s, c;
        sineAndCosineOf(scale * p.x, s.x, c.x);
        sineAndCosineOf(scale * p.y, s.y, c.y);
        sineAndCosineOf(scale * p.z, s.z, c.z);
        const Number g = s.x * c.y + s.y * c.z + s.z * c.x;
        return (absolute(g) - Number(0.3f)) * Number(0.8f);
    }

    template <class Number>
    static void values(const Point<Number> &p, Number (&value)[SURFACES]) {
        const Point<Number> q = p - Vec3{1, -1, 1};
        value[0] = -boxDistance(p, Vec3{9, 4.5f, 8});
        value[1] = cutOff(field(q), 2, q, Vec3{5, 3, 5});
    }
};

// ---- ground.ron

// A hash of a cell, from 0 to 1. The coordinates of cells are integers.
inline double hashed(double x, double z) {
    const auto whole = [](double at) { return static_cast<uint32_t>(static_cast<int>(at) + 1024); };
    uint32_t bits = whole(x) * 374761393u + whole(z) * 668265263u;
    bits = (bits ^ (bits >> 13)) * 1274126177u;
    return (bits >> 22) / 1023.0;
}

inline Lanes hashed(Lanes x, Lanes z) {
    const auto times = [](__m256i a, uint32_t b) {
        return _mm256_mullo_epi32(a, _mm256_set1_epi32(static_cast<int>(b)));
    };
    const auto whole = [](Lanes at) {
        return _mm256_add_epi32(_mm256_cvtps_epi32(at.v), _mm256_set1_epi32(1024));
    };
    __m256i bits = _mm256_add_epi32(times(whole(x), 374761393u), times(whole(z), 668265263u));
    bits = times(_mm256_xor_si256(bits, _mm256_srli_epi32(bits, 13)), 1274126177u);
    return Lanes(_mm256_cvtepi32_ps(_mm256_srli_epi32(bits, 22))) * (1.0f / 1023.0f);
}

struct Ground {
    static constexpr Vec3 SOURCE{-7, 2.5f, -7};
    static constexpr Vec3 LISTENER{7, 1, 7};
    static constexpr float LISTENER_RADIUS = 1;
    static constexpr int SURFACES = 2;

    template <class Number>
    static Number noise(Number x, Number z) {
        const Number one(1.0f);
        const auto smooth = [](Number f) {
            return f * f * f * (f * (f * Number(6.0f) - Number(15.0f)) + Number(10.0f));
        };
        const Number cellX = roundDown(x), cellZ = roundDown(z);
        const Number acrossX = smooth(x - cellX), acrossZ = smooth(z - cellZ);
        const auto between = [](Number a, Number b, Number share) { return a + share * (b - a); };
        const Number near = between(hashed(cellX, cellZ), hashed(cellX + one, cellZ), acrossX);
        const Number far = between(hashed(cellX, cellZ + one), hashed(cellX + one, cellZ + one), acrossX);
        return between(near, far, acrossZ);
    }

    template <class Number>
    static Number field(const Point<Number> &p) {
        Number height(0.0f), amplitude(1.2f), x = Number(0.2f) * p.x, z = Number(0.2f) * p.z;
        for (int octave = 0; octave < 5; octave++) {
            height = height + amplitude * noise(x, z);
            amplitude = amplitude * Number(0.45f);
            x = Number(2.0f) * x + Number(7.0f);
            z = Number(2.0f) * z + Number(7.0f);
        }
        return p.y + Number(2.0f) - height;
    }

    template <class Number>
    static void values(const Point<Number> &p, Number (&value)[SURFACES]) {
        const Point<Number> q = p - Vec3{0, -3, 0};
        value[0] = -boxDistance(p, Vec3{11, 6, 11});
        value[1] = cutOff(field(q), 2.5f, q, Vec3{12, 4, 12});
    }
};

// ----

// The distance to the nearest surface of a scene.
template <class Scene, class Number>
Number nearest(const Point<Number> &p) {
    Number values[Scene::SURFACES];
    Scene::values(p, values);
    Number least = values[0];
    for (int surface = 1; surface < Scene::SURFACES; surface++) {
        least = min(least, values[surface]);
    }
    return least;
}

template <class Scene, class Number>
Number listenerDistance(const Point<Number> &p) {
    return length(p - Scene::LISTENER) - Number(Scene::LISTENER_RADIUS);
}
