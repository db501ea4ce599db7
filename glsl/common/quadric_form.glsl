// Functions that all quadrics share.

// A lower bound of the distance to the surface where a quadratic function vanishes, from its
// value, the length g of its gradient and the norm of its form: |value| <= g r + norm r^2,
// solved for r. It agrees with the distance to first order at the surface.
float quadricDistance(float value, float g, float norm) {
    return 2.0 * value / max(g + sqrt(g * g + 4.0 * norm * abs(value)), 1e-30);
}

// The gradient of this bound, and its value, from the function's gradient and the form times that
// gradient.
vec4 quadricGradient(float value, vec3 gradient, vec3 formGradient, float norm) {
    float g = length(gradient);
    float off = quadricDistance(value, g, norm);
    vec3 growth = gradient - off * 2.0 * formGradient / max(g, 1e-30);
    return vec4(growth / max(2.0 * norm * abs(off) + g, 1e-30), off);
}

// The t at which a t^2 + 2 b t + c changes from positive to negative, or NO_HIT. A wave that leaves
// the surface starts at the other root. The formula avoids cancellation; t may be negative.
float fallingRoot(float a, float b, float c) {
    float under = b * b - a * c;
    if (under <= 0.0) {
        return NO_HIT;
    }
    float root = sqrt(under);
    if (b < 0.0) {
        return c / (root - b);
    }
    return a != 0.0 ? (b + root) / -a : NO_HIT;
}

// The distance from p along d to the point nearest to the origin. For t measured from that point the
// coefficients above are small, however far away p is, and their difference keeps its digits.
float wayToOrigin(vec3 p, vec3 d) {
    return max(-dot(p, d), 0.0);
}

// The hit for a root measured from that point. A root behind the start does not count as a hit,
// unless rounding put the start into the solid (value < 0) and the ray goes further in (growth < 0).
float rootFrom(float way, float root, float value, float growth) {
    float t = way + root;
    if (t >= 0.0) {
        return min(t, NO_HIT);
    }
    return value < 0.0 && growth < 0.0 ? 0.0 : NO_HIT;
}

// A quadric's value r = 2 F / (g + sqrt(g^2 + 4 norm |F|)) solves r g + norm r |r| = F. Its second derivative
// along a line, with |F'| <= g, |g'| <= 2 norm, |g''| <= 4 norm^2 / g, |F''| <= 2 norm and |r'| <= 1, is
// bounded by |r''| <= 10 norm / g. Over g / (4 norm) metres g stays above half its value.
vec4 quadricAlong(float side, vec4 gradient, vec3 d, float g, float norm) {
    vec3 bend = bendOfQuadric(g, norm);
    return vec4(side * gradient.w, side * dot(gradient.xyz, d), bend.xz);
}

vec3 bendOfQuadric(float g, float norm) {
    float most = 20.0 * norm / max(g, 1e-30);
    return vec3(most, most, g / max(4.0 * norm, 1e-30));
}

// For diagonal . p^2 + constant, an ellipsoid or a hyperboloid about the origin: a bound of the
// distance, exact to first order.
float centredQuadricDistance(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    return quadricDistance(dot(p, form) + constant, 2.0 * length(form), norm);
}

vec4 centredQuadricGradient(vec3 p, vec3 diagonal, float constant, float norm) {
    vec3 form = diagonal * p;
    return quadricGradient(dot(p, form) + constant, 2.0 * form, 2.0 * diagonal * form, norm);
}

// Hit of a ray from the air (inside for sign -1) with diagonal . p^2 + constant = 0.
float centredQuadricHit(vec3 p, vec3 d, float sign, vec3 diagonal, float constant) {
    float way = wayToOrigin(p, d);
    vec3 q = p + way * d;
    vec3 form = sign * diagonal * q;
    float a = sign * dot(d, diagonal * d);
    float root = fallingRoot(a, dot(d, form), dot(q, form) + sign * constant);
    vec3 start = sign * diagonal * p;
    return rootFrom(way, root, dot(p, start) + sign * constant, dot(d, start));
}
