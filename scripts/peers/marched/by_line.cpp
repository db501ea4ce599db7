// A tracer for `cave` that evaluates the rock once or twice per flight, eight waves in a register. It shows
// the speed of a march that is specialised for its fields on this processor.
//
// - On a wave's line every part of the air is a function of one number. Its constants are computed once per
//   flight.
// - Steps are proven by the slope and by a bound of the second derivative: above the rock's value f lies no
//   surface before the root of f + s x - K x²/2. The bound holds where the value is at most BAND.
// - Each part of the air is convex, and the rock's value is positive inside it. From a point in a part, the
//   wave continues at the point where its line leaves that part.
// - A flight ends with a Newton step. One gradient gives the normal and the last correction.
// - Stones and listener have a closed form.
#include "waves.h"

namespace {

// Greatest second derivative of a part of the air along a line, in 1/m, where the rock's value is at most
// BAND: 1 / (1.8 - 0.9) for the passage, which has the greatest curvature; the egg's curvature is smaller.
constexpr float BEND = 1 / 0.9f;
constexpr float BAND = 0.9f; // metres
// A step may end where the tangent's root is known to this square, in square metres.
constexpr float CLOSE = 2e-7f;
// Distance in metres before the end of a part at which a wave continues, so that rounding does not move it
// beyond a surface.
constexpr float SPARE = 3e-5f;
constexpr float LEAST_STEP = 1e-6f;
constexpr float TINY = 1e-20f;
constexpr float NEVER = 1e9f;
constexpr int STEPS = 200;
// Numbers of the objects, as in reference.cpp.
constexpr float LISTENER = 0, ROCK = 1, STANDING = 2, HANGING = 3, BOULDER = 4;

inline Lanes inverseRoot(Lanes a) {
    const Lanes guess = _mm256_rsqrt_ps(a.v);
    return guess * fma(a * guess * -0.5f, guess, 1.5f);
}

inline Lanes3 minus(const Lanes3 &p, Vec3 c) { return {p.x - c.x, p.y - c.y, p.z - c.z}; }
inline Lanes3 scaled(const Lanes3 &p, Lanes by) { return {p.x * by, p.y * by, p.z * by}; }

// A value with its derivative along the line.
struct Slope {
    Lanes value, slope;
};

struct Interval {
    Lanes enter, exit;
};

// The squared distance to an axis or a centre along the line; the minimum is at `middle`.
struct Ball {
    Lanes middle, least;
    float radius;

    Ball(const Lanes3 &o, const Lanes3 &d, float radius) : middle(-dot(o, d)), radius(radius) {
        const Lanes3 near = along(o, d, middle);
        least = dot(near, near);
    }

    Slope at(Lanes t) const {
        const Lanes u = t - middle, square = max(fma(u, u, least), TINY), inverse = inverseRoot(square);
        return {fma(square, inverse, -radius), u * inverse};
    }

    Interval within() const {
        const Lanes half = squareRoot(max(radius * radius - least, 0.0f));
        return {middle - half, middle + half};
    }
};

struct Egg {
    Lanes middle, least, grow, g0, g1, g2;
    static constexpr Vec3 D{1 / (Cave::EGG_RADII.x * Cave::EGG_RADII.x), 1 / (Cave::EGG_RADII.y * Cave::EGG_RADII.y),
                            1 / (Cave::EGG_RADII.z * Cave::EGG_RADII.z)};
    static constexpr float NORM = D.y; // of the greatest second derivative

    Egg(const Lanes3 &o, const Lanes3 &d) {
        const Lanes3 m = weighted(d);
        grow = dot(d, m);
        const Lanes inverse = Lanes(1.0f) / grow;
        middle = -dot(o, m) * inverse;
        const Lanes3 q = along(o, d, middle), w = weighted(q);
        least = dot(q, w) - 1.0f;
        g0 = dot(w, w) * 4.0f;
        g1 = dot(w, m) * 8.0f;
        g2 = dot(m, m) * 4.0f;
    }

    static Lanes3 weighted(const Lanes3 &p) { return {p.x * D.x, p.y * D.y, p.z * D.z}; }

    Slope at(Lanes t) const {
        const Lanes u = t - middle, F = fma(grow * u, u, least);
        const Lanes square = max(fma(u, fma(u, g2, g1), g0), TINY), inverse = inverseRoot(square);
        const Lanes g = square * inverse, root = squareRoot(fma(absolute(F), 4 * NORM, square));
        const Lanes value = F * 2.0f / (g + root);
        const Lanes growth = fma(u, g2, g1 * 0.5f) * inverse;
        const Lanes slope = (grow * u * 2.0f - value * growth) / fma(absolute(value), 2 * NORM, g);
        return {value, slope};
    }

    Interval within() const {
        const Lanes half = squareRoot(max(-least / grow, 0.0f));
        return {middle - half, middle + half};
    }
};

// The passage: a capsule along x.
struct Passage {
    Lanes x, dx, middle, least, across;

    Passage(const Lanes3 &o, const Lanes3 &d) : x(o.x), dx(d.x) {
        across = max(fma(d.y, d.y, d.z * d.z), TINY);
        middle = -fma(o.y, d.y, o.z * d.z) / across;
        const Lanes y = fma(middle, d.y, o.y), z = fma(middle, d.z, o.z);
        least = fma(y, y, z * z);
    }

    Slope at(Lanes t) const {
        const Lanes u = t - middle, at = fma(t, dx, x);
        const Lanes beyond = at - max(min(at, Cave::PASSAGE_HALF), -Cave::PASSAGE_HALF);
        const Lanes square = max(fma(beyond, beyond, fma(across * u, u, least)), TINY), inverse = inverseRoot(square);
        return {fma(square, inverse, -Cave::PASSAGE_RADIUS), fma(across, u, beyond * dx) * inverse};
    }

    // Of the capsule's cylinder.
    Interval within() const {
        constexpr float square = Cave::PASSAGE_RADIUS * Cave::PASSAGE_RADIUS;
        const Lanes half = squareRoot(max(square - least, 0.0f) / across);
        const Lanes inverse = Lanes(1.0f) / (absolute(dx) + TINY);
        const Lanes between = -(x ^ signOf(dx)) * inverse, reach = inverse * Cave::PASSAGE_HALF;
        return {max(middle - half, between - reach), min(middle + half, between + reach)};
    }
};

Slope rounded(const Slope &a, const Slope &b) {
    const Lanes h = max(Cave::ROUNDED - absolute(a.value - b.value), 0.0f);
    const Lanes share = h * (0.5f / Cave::ROUNDED), less = a.value < b.value;
    const Lanes low = select(less, a.slope, b.slope), high = select(less, b.slope, a.slope);
    return {min(a.value, b.value) - h * h * (0.25f / Cave::ROUNDED), fma(share, high - low, low)};
}

// The rock along a wave's line.
struct Rock {
    Egg egg;
    Ball hall, niche;
    Passage passage;
    Interval parts[4];

    Rock(const Lanes3 &o, const Lanes3 &d)
        : egg(minus(o, Cave::EGG), d), hall(minus(o, Cave::HALL), d, Cave::HALL_RADIUS),
          niche(minus(o, Cave::NICHE), d, Cave::NICHE_RADIUS), passage(o, d),
          parts{egg.within(), hall.within(), niche.within(), passage.within()} {
        for (Interval &part : parts) {
            part.exit = part.exit - SPARE;
        }
    }

    Slope at(Lanes t) const {
        const Slope air = rounded(rounded(rounded(egg.at(t), hall.at(t)), niche.at(t)), passage.at(t));
        return {-air.value, -air.slope};
    }

    // Leaves the parts in which t lies.
    Lanes beyondParts(Lanes t) const {
        for (const Interval &part : parts) {
            t = select(part.enter <= t, max(t, part.exit), t);
        }
        return t;
    }

    // The length of the flight to the rock. For waves that do not hit the rock within `limit` it is at least
    // `limit`, or NEVER.
    Lanes march(Lanes limit, Lanes active) const {
        Lanes t = beyondParts(0.0f), end = NEVER;
        for (int step = 0; step < STEPS; step++) {
            const Slope f = at(t);
            const Lanes goesIn = f.slope < 0.0f, bent = f.value * f.value * BEND, square = f.slope * f.slope;
            const Lanes met = active & goesIn & (bent < square * CLOSE) &
                              (absolute(f.value) * BEND < square * 0.25f);
            end = select(met, t - f.value / f.slope, end);
            active = andNot(met, active) & (t < limit);
            if (!bits(active)) {
                break;
            }
            const Lanes root = squareRoot(fma(max(f.value, 0.0f), 2 * BEND, square));
            const Lanes way = select(goesIn, f.value * 2.0f / (root - f.slope), (f.slope + root) * (1 / BEND));
            t = beyondParts(t + max(max(f.value, min(way, BAND - f.value)), LEAST_STEP));
        }
        return max(end, 0.0f);
    }
};

// ---- closed forms

struct Nearest {
    Lanes t, object;

    void take(Lanes other, Lanes valid, float number) {
        const Lanes nearer = valid & (other < t);
        t = select(nearer, other, t);
        object = select(nearer, number, object);
    }
};

// Where the line enters an ellipsoid with the centre at the origin of `o` and these axes, in its scaled space.
void enterEllipsoid(const Lanes3 &o, const Lanes3 &d, Vec3 radii, float number, Lanes may, Nearest &nearest) {
    const Lanes3 p{o.x * (1 / radii.x), o.y * (1 / radii.y), o.z * (1 / radii.z)};
    const Lanes3 v{d.x * (1 / radii.x), d.y * (1 / radii.y), d.z * (1 / radii.z)};
    const Lanes square = dot(v, v), middle = -dot(p, v) / square;
    const Lanes3 near = along(p, v, middle);
    const Lanes within = Lanes(1.0f) - dot(near, near);
    const Lanes enter = middle - squareRoot(max(within, 0.0f) / square);
    nearest.take(enter, may & (Lanes(0.0f) < within) & (Lanes(0.0f) < enter), number);
}

// Where the line enters a cone with its apex up.
void enterCone(const Lanes3 &o, const Lanes3 &d, float radius, float number, Lanes may, Nearest &nearest) {
    constexpr float half = Cave::CONE_HALF;
    const float k = radius / (2 * half), k2 = k * k;
    // From the point nearest to the apex, so that no large numbers cancel.
    const Lanes3 fromApex{o.x, o.y - half, o.z};
    const Lanes middle = -dot(fromApex, d);
    const Lanes3 p = along(fromApex, d, middle);
    const Lanes a = fma(d.x, d.x, d.z * d.z) - d.y * d.y * k2;
    const Lanes b = fma(p.x, d.x, p.z * d.z) - p.y * d.y * k2;
    const Lanes c = fma(p.x, p.x, p.z * p.z) - p.y * p.y * k2;
    const Lanes discriminant = fma(b, b, -(a * c)), real = Lanes(0.0f) <= discriminant;
    const Lanes root = squareRoot(max(discriminant, 0.0f));
    const Lanes q = -(b + (root ^ signOf(b)));
    for (const Lanes u : {q / a, c / q}) {
        const Lanes y = fma(u, d.y, p.y), t = middle + u;
        // Half the derivative of the square, which is negative inside.
        const Lanes goesIn = fma(u, a, b) < 0.0f;
        nearest.take(t, may & real & goesIn & (Lanes(0.0f) < t) & (Lanes(-2 * half) < y) & (y < 0.0f), number);
    }
    const Lanes t = -(o.y + half) / d.y;
    const Lanes x = fma(t, d.x, o.x), z = fma(t, d.z, o.z);
    const Lanes onBase = fma(x, x, z * z) < radius * radius;
    nearest.take(t, may & (Lanes(0.0f) < d.y) & (Lanes(0.0f) < t) & onBase, number);
}

Lanes3 hanging(const Lanes3 &p) {
    const Lanes3 q = minus(p, Cave::HANGING);
    return {q.x, -q.y, q.z};
}

// The listener and the stones. The stone that mirrored a wave last is convex, so it cannot be hit next.
Nearest closedForms(const Lanes3 &o, const Lanes3 &d, Lanes left) {
    Nearest nearest{NEVER, -1.0f};
    const float r = Cave::LISTENER_RADIUS;
    enterEllipsoid(minus(o, Cave::LISTENER), d, {r, r, r}, LISTENER, allSet(), nearest);
    enterCone(minus(o, Cave::STANDING), d, Cave::STANDING_RADIUS, STANDING, left != STANDING, nearest);
    enterCone(hanging(o), {d.x, -d.y, d.z}, Cave::HANGING_RADIUS, HANGING, left != HANGING, nearest);
    enterEllipsoid(minus(o, Cave::BOULDER), d, Cave::BOULDER_RADII, BOULDER, left != BOULDER, nearest);
    return nearest;
}

// ---- normals

// A value with its gradient, which need not have the length 1.
struct Gradient {
    Lanes value;
    Lanes3 gradient;
};

Gradient gradientOfBall(const Lanes3 &p, float radius) {
    const Lanes distance = squareRoot(max(dot(p, p), TINY));
    return {distance - radius, scaled(p, Lanes(1.0f) / distance)};
}

Gradient gradientOfEgg(const Lanes3 &p) {
    const Lanes3 w = Egg::weighted(p), ww = Egg::weighted(w);
    const Lanes F = dot(p, w) - 1.0f, g = squareRoot(dot(w, w)) * 2.0f;
    const Lanes value = F * 2.0f / (g + squareRoot(fma(absolute(F), 4 * Egg::NORM, g * g)));
    const Lanes growth = value * 4.0f / g, inverse = Lanes(1.0f) / fma(absolute(value), 2 * Egg::NORM, g);
    const auto axis = [&](Lanes w, Lanes ww) { return (w * 2.0f - growth * ww) * inverse; };
    return {value, {axis(w.x, ww.x), axis(w.y, ww.y), axis(w.z, ww.z)}};
}

Gradient rounded(const Gradient &a, const Gradient &b) {
    const Lanes h = max(Cave::ROUNDED - absolute(a.value - b.value), 0.0f);
    const Lanes share = h * (0.5f / Cave::ROUNDED), less = a.value < b.value;
    const Lanes ofA = select(less, Lanes(1.0f) - share, share);
    const auto axis = [&](Lanes a, Lanes b) { return fma(ofA, a - b, b); };
    return {min(a.value, b.value) - h * h * (0.25f / Cave::ROUNDED),
            {axis(a.gradient.x, b.gradient.x), axis(a.gradient.y, b.gradient.y), axis(a.gradient.z, b.gradient.z)}};
}

Gradient gradientOfRock(const Lanes3 &p) {
    const Lanes3 passage{p.x - max(min(p.x, Cave::PASSAGE_HALF), -Cave::PASSAGE_HALF), p.y, p.z};
    Gradient air = rounded(gradientOfEgg(minus(p, Cave::EGG)), gradientOfBall(minus(p, Cave::HALL), Cave::HALL_RADIUS));
    air = rounded(air, gradientOfBall(minus(p, Cave::NICHE), Cave::NICHE_RADIUS));
    air = rounded(air, gradientOfBall(passage, Cave::PASSAGE_RADIUS));
    return {-air.value, {-air.gradient.x, -air.gradient.y, -air.gradient.z}};
}

// The normal of the base or the side, whichever is nearer.
Gradient gradientOfCone(const Lanes3 &p, float radius) {
    constexpr float half = Cave::CONE_HALF;
    const float slant = std::sqrt(4 * half * half + radius * radius);
    const float outwards = 2 * half / slant, upwards = radius / slant;
    const Lanes axis = squareRoot(max(fma(p.x, p.x, p.z * p.z), TINY)), share = Lanes(outwards) / axis;
    const Lanes side = fma(axis - radius, outwards, (p.y + half) * upwards), base = -(p.y + half);
    const Lanes onBase = side < base;
    return {max(side, base), select(onBase, Lanes3{0.0f, -1.0f, 0.0f}, Lanes3{p.x * share, upwards, p.z * share})};
}

Gradient gradientOfBoulder(const Lanes3 &p) {
    constexpr Vec3 r = Cave::BOULDER_RADII;
    const Lanes3 w{p.x * (1 / (r.x * r.x)), p.y * (1 / (r.y * r.y)), p.z * (1 / (r.z * r.z))};
    return {(dot(p, w) - 1.0f) * 0.5f, w};
}

// Moves waves onto the surfaces that they meet and mirrors them there.
void mirror(Lanes object, Lanes3 &p, Lanes3 &d) {
    Gradient found = gradientOfRock(p);
    const auto take = [&](float number, const auto &gradientOf) {
        const Lanes mine = object == number;
        if (bits(mine)) {
            const Gradient other = gradientOf();
            found = {select(mine, other.value, found.value), select(mine, other.gradient, found.gradient)};
        }
    };
    take(STANDING, [&] { return gradientOfCone(minus(p, Cave::STANDING), Cave::STANDING_RADIUS); });
    take(HANGING, [&] {
        Gradient up = gradientOfCone(hanging(p), Cave::HANGING_RADIUS);
        up.gradient.y = -up.gradient.y;
        return up;
    });
    take(BOULDER, [&] { return gradientOfBoulder(minus(p, Cave::BOULDER)); });
    const Lanes3 g = found.gradient;
    const Lanes inverse = Lanes(1.0f) / dot(g, g);
    p = along(p, g, -found.value * inverse);
    d = along(d, g, dot(d, g) * inverse * -2.0f);
    d = scaled(d, Lanes(1.0f) / squareRoot(dot(d, d)));
}

void trace(const FourFloats *directions, uint32_t iterations, FourFloats *ends) {
    Lanes3 d = loadEight(directions), o{Cave::SOURCE.x, Cave::SOURCE.y, Cave::SOURCE.z};
    Lanes status = TRAVELLING, left = -1.0f, travelling = allSet();
    for (uint32_t iteration = 0; iteration < iterations && bits(travelling); iteration++) {
        const Nearest closed = closedForms(o, d, left);
        const Lanes rock = Rock(o, d).march(closed.t, travelling);
        const Lanes hitsRock = rock < closed.t;
        const Lanes t = select(hitsRock, rock, closed.t), object = select(hitsRock, ROCK, closed.object);
        const Lanes lost = travelling & (t == NEVER), heard = travelling & (object == LISTENER);
        Lanes3 p = along(o, d, select(lost, 0.0f, t)), mirrored = d;
        const Lanes goesOn = andNot(lost | heard, travelling);
        o = select(heard, p, o);
        mirror(object, p, mirrored);
        o = select(goesOn, p, o);
        d = select(goesOn, mirrored, d);
        left = select(goesOn, object, left);
        status = select(heard, HEARD, select(lost, LOST, status));
        travelling = goesOn;
    }
    storeEight(ends, o, status);
}

} // namespace

int main(int count, char **values) {
    return guarded([&] {
        expectArguments(count, 6, values, "cave DIRECTIONS ITERATIONS FRAMES ENDS");
        if (std::string(values[1]) != "cave") {
            throw std::runtime_error("this design is written for the cave alone");
        }
        timeWaves(values, trace);
    });
}
