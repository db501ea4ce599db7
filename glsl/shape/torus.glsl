// A torus about y.

// A torus about y. Exact.
float sdTorus(vec3 p, float ring, float tube) {
    return length(vec2(length(p.xz) - ring, p.y)) - tube;
}

vec4 gdTorus(vec3 p, float ring, float tube) {
    float apart = length(p.xz);
    vec2 q = vec2(apart - ring, p.y);
    float off = length(q);
    q /= max(off, 1e-30);
    vec2 outward = q.x * p.xz / max(apart, 1e-30);
    return vec4(outward.x, q.y, outward.y, off - tube);
}

// The second derivative of the distance to the ring's centre line is at least -1 / (distance from the
// axis), and at most 1 / (distance to the centre line); both distances keep at least half their value over
// the reach.
vec4 alongTorus(vec4 gradient, vec3 p, vec3 d, float ring, float tube) {
    float fromAxis = length(p.xz);
    return vec4(gradient.w, dot(gradient.xyz, d), 2.0 / max(fromAxis, 1e-30), 0.5 * fromAxis);
}

vec4 alongTorusSolid(vec4 gradient, vec3 p, vec3 d, float ring, float tube) {
    float least = min(length(p.xz), gradient.w + tube);
    return vec4(-gradient.w, -dot(gradient.xyz, d), 2.0 / max(least, 1e-30), 0.5 * least);
}

// The second derivative of the distance from the ring's centre line, as in alongTorus.
vec3 bendTorus(vec4 gradient, vec3 p, float ring, float tube) {
    float fromAxis = length(p.xz);
    float fromLine = max(gradient.w + tube, 0.0);
    return vec3(2.0 / max(fromAxis, 1e-30), 2.0 / max(fromLine, 1e-30), 0.5 * min(fromAxis, fromLine));
}
