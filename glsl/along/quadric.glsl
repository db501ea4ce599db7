// A quadric's value r = 2 F / (g + sqrt(g^2 + 4 norm |F|)) solves r g + norm r |r| = F. Derived
// twice along a line, with |F'| <= g, |g'| <= 2 norm, |g''| <= 4 norm^2 / g, |F''| <= 2 norm and
// |r'| <= 1, that gives |r''| <= 10 norm / g. Over g / (4 norm) metres g stays above its half.
vec4 quadricAlong(float side, vec4 gradient, vec3 d, float g, float norm) {
    float bend = 20.0 * norm / max(g, 1e-30);
    return vec4(side * gradient.w, side * dot(gradient.xyz, d), bend, g / max(4.0 * norm, 1e-30));
}
