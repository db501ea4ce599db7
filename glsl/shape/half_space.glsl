// A half space.

// A half-space: solid where the unit normal times p is below the offset. Exact.
float sdHalfSpace(vec3 p, vec3 normal, float offset) {
    return dot(normal, p) - offset;
}

vec4 gdHalfSpace(vec3 p, vec3 normal, float offset) {
    return vec4(normal, sdHalfSpace(p, normal, offset));
}

// Hit of a ray from the air with a half-space.
float hitHalfSpace(vec3 p, vec3 d, vec3 normal, float offset, float errorBound) {
    float closing = -dot(normal, d);
    return closing > 0.0 ? max((dot(normal, p) - offset) / closing, 0.0) : NO_HIT;
}

vec3 bendHalfSpace(vec4 gradient, vec3 p, vec3 normal, float offset) { return vec3(0.0, 0.0, NO_END); }

vec2 chordHalfSpace(vec3 p, vec3 d, float side, vec3 normal, float offset) {
    return chordBehindPlane(side * (dot(normal, p) - offset), side * dot(normal, d));
}
