// A plane.

// Signed distance to the plane y = 0: air above, solid below. Exact.
float sdPlane(vec3 p) {
    return p.y;
}

vec3 gradientPlane(vec3 p) {
    return vec3(0.0, 1.0, 0.0);
}

vec4 gdPlane(vec3 p) {
    return vec4(0.0, 1.0, 0.0, p.y);
}

// Hit of a ray from p along the unit vector d with the plane y = 0, from above.
float hitPlane(vec3 p, vec3 d) {
    return d.y < 0.0 ? max(p.y / -d.y, 0.0) : NO_HIT;
}

// Projects a hit point onto the plane, and returns the normal there.
void projectPlane(inout vec3 p, out vec3 normal) {
    p.y = 0.0;
    normal = vec3(0.0, 1.0, 0.0);
}

// Distance to the plane, or NEVER for a wave along d that moves away from it.
float sdPlaneDirected(vec3 p, vec3 d) {
    const float NEVER = 1e30;
    return d.y >= 0.0 ? NEVER : p.y;
}

vec3 bendPlane(vec4 gradient, vec3 p) { return vec3(0.0, 0.0, NO_END); }

vec2 chordPlane(vec3 p, vec3 d, float side) { return chordBehindPlane(side * p.y, side * d.y); }
