// A finite cylinder about y.

// A finite cylinder about y. Exact.
float sdCappedCylinder(vec3 p, float radius, float halfHeight) {
    return sdCorner(vec2(length(p.xz) - radius, abs(p.y) - halfHeight));
}

vec4 gdCappedCylinder(vec3 p, float radius, float halfHeight) {
    float apart = length(p.xz);
    vec2 beyond = vec2(apart - radius, abs(p.y) - halfHeight);
    vec2 shares = cornerShares(beyond);
    vec2 outward = shares.x * p.xz / max(apart, 1e-30);
    return vec4(outward.x, p.y < 0.0 ? -shares.y : shares.y, outward.y, sdCorner(beyond));
}

// Hit of a ray with a finite cylinder about y: the intersection of its chords through the infinite
// cylinder and the slab.
float hitCappedCylinder(vec3 p, vec3 d, float radius, float halfHeight, float errorBound) {
    float speed = length(d.xz);
    float enter = -NO_HIT;
    float leave = NO_HIT;
    if (speed > 1e-12) {
        vec2 heading = d.xz / speed;
        float along = dot(p.xz, heading);
        vec2 aside = p.xz - along * heading;
        float under = radius * radius - dot(aside, aside);
        if (under <= 0.0) {
            return NO_HIT;
        }
        float reach = sqrt(under);
        enter = (-along - reach) / speed;
        leave = (reach - along) / speed;
    } else if (dot(p.xz, p.xz) >= radius * radius) {
        return NO_HIT;
    }
    clipToSlab(p.y, d.y, halfHeight, enter, leave);
    return hitChord(enter, leave, errorBound);
}

float exitCappedCylinder(vec3 p, vec3 d, float radius, float halfHeight) {
    return min(exitCylinder(p, d, radius), exitSlab(p.y, d.y, halfHeight));
}

vec2 chordCappedCylinder(vec3 p, vec3 d, float radius, float halfHeight) {
    vec2 chord = chordCylinder(p, d, radius);
    clipToSlab(p.y, d.y, halfHeight, chord.x, chord.y);
    return chord;
}
