// A box with rounded edges.

// A box with rounded edges: the distance to its core, less the rounding. Exact.
float sdRoundedBox(vec3 p, vec3 core, float rounding) {
    return sdBox(p, core) - rounding;
}

vec4 gdRoundedBox(vec3 p, vec3 core, float rounding) {
    return vec4(gradientBox(p, core), sdRoundedBox(p, core, rounding));
}

// Distance at which a line leaves a rounded box through a flat part of its faces; 0 for the rounded parts.
float exitRoundedBox(vec3 p, vec3 d, vec3 core, float rounding, float errorBound) {
    float way = exitBox(p, d, core + rounding);
    return sdRoundedBox(p + way * d, core, rounding) <= errorBound ? way : 0.0;
}

// Outside its core the value is the distance from the core, less the rounding.
vec3 bendRoundedBox(vec4 gradient, vec3 p, vec3 core, float rounding) {
    return bendOfDistance(gradient.w + rounding);
}

// The solid is the least convex one that contains these three boxes and the rounding.
vec2 chordRoundedBox(vec3 p, vec3 d, vec3 core, float rounding) {
    vec2 x = chordBox(p, d, core + vec3(rounding, 0.0, 0.0));
    vec2 y = chordBox(p, d, core + vec3(0.0, rounding, 0.0));
    vec2 z = chordBox(p, d, core + vec3(0.0, 0.0, rounding));
    vec2 all = NO_CHORD;
    all = x.x < x.y ? hullOfChords(all, x) : all;
    all = y.x < y.y ? hullOfChords(all, y) : all;
    return z.x < z.y ? hullOfChords(all, z) : all;
}
