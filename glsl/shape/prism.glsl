// A triangle, extruded.

// A triangle a b c of positive orientation in the xy plane, extruded along z. Exact.
bool isBeside(vec2 p, vec2 a, vec2 b) {
    return dot(p - a, b - a) >= 0.0 && dot(p - b, b - a) <= 0.0;
}

vec3 triangleDistance(vec2 p, vec2 a, vec2 b, vec2 c) {
    vec2 ab = fromSegment(p, a, b);
    vec2 bc = fromSegment(p, b, c);
    vec2 ca = fromSegment(p, c, a);
    vec2 outAb = normalize(vec2(b.y - a.y, a.x - b.x));
    vec2 outBc = normalize(vec2(c.y - b.y, b.x - c.x));
    vec2 outCa = normalize(vec2(a.y - c.y, c.x - a.x));
    vec3 beyond = vec3(dot(outAb, p - a), dot(outBc, p - b), dot(outCa, p - c));
    float most = max(beyond.x, max(beyond.y, beyond.z));
    vec2 face = beyond.x >= beyond.y && beyond.x >= beyond.z ? outAb : beyond.y >= beyond.z ? outBc : outCa;
    if (most <= 0.0) {
        return vec3(face, most);
    }
    // Beside an edge the direction is the edge's normal, so that rounding near the surface cannot tilt
    // it.
    if (beyond.x > 0.0 && isBeside(p, a, b)) {
        return vec3(outAb, beyond.x);
    }
    if (beyond.y > 0.0 && isBeside(p, b, c)) {
        return vec3(outBc, beyond.y);
    }
    if (beyond.z > 0.0 && isBeside(p, c, a)) {
        return vec3(outCa, beyond.z);
    }
    vec2 way = dot(ab, ab) < dot(bc, bc) ? ab : bc;
    way = dot(ca, ca) < dot(way, way) ? ca : way;
    float off = length(way);
    return vec3(off > 0.0 ? way / off : face, off);
}

float sdPrism(vec3 p, vec2 a, vec2 b, vec2 c, float halfDepth) {
    float flat_ = triangleDistance(p.xy, a, b, c).z;
    return sdCorner(vec2(flat_, abs(p.z) - halfDepth));
}

vec4 gdPrism(vec3 p, vec2 a, vec2 b, vec2 c, float halfDepth) {
    vec3 triangle = triangleDistance(p.xy, a, b, c);
    vec2 beyond = vec2(triangle.z, abs(p.z) - halfDepth);
    vec2 shares = cornerShares(beyond);
    return vec4(shares.x * triangle.xy, p.z < 0.0 ? -shares.y : shares.y, sdCorner(beyond));
}

// Clips a chord to the half plane behind an edge; for a parallel line outside it, the chord is empty
// (leave < enter).
void clipToEdge(vec2 p, vec2 d, vec2 from, vec2 to, inout float enter, inout float leave) {
    vec2 outward = normalize(vec2(to.y - from.y, from.x - to.x));
    float beyond = dot(outward, p - from);
    float speed = dot(outward, d);
    if (abs(speed) < 1e-12) {
        leave = beyond >= 0.0 ? -NO_HIT : leave;
    } else if (speed < 0.0) {
        enter = max(enter, beyond / -speed);
    } else {
        leave = min(leave, -beyond / speed);
    }
}

// Hit of a ray with a triangle a b c of positive orientation, extruded along z: the ray is inside the prism
// where it is behind all five planes.
float hitPrism(vec3 p, vec3 d, vec2 a, vec2 b, vec2 c, float halfDepth, float errorBound) {
    float enter = -NO_HIT;
    float leave = NO_HIT;
    clipToEdge(p.xy, d.xy, a, b, enter, leave);
    clipToEdge(p.xy, d.xy, b, c, enter, leave);
    clipToEdge(p.xy, d.xy, c, a, enter, leave);
    clipToSlab(p.z, d.z, halfDepth, enter, leave);
    return hitChord(enter, leave, errorBound);
}

float exitEdge(vec2 p, vec2 d, vec2 from, vec2 to) {
    vec2 outward = normalize(vec2(to.y - from.y, from.x - to.x));
    float speed = dot(outward, d);
    return speed > 0.0 ? dot(outward, from - p) / speed : NO_END;
}

float exitPrism(vec3 p, vec3 d, vec2 a, vec2 b, vec2 c, float halfDepth) {
    float side = min(exitEdge(p.xy, d.xy, a, b), min(exitEdge(p.xy, d.xy, b, c), exitEdge(p.xy, d.xy, c, a)));
    return min(side, exitSlab(p.z, d.z, halfDepth));
}
