// Where a ray meets a triangle a b c of positive sense, extruded along z: it is in where it
// is behind all five planes.
void hitEdge(vec2 p, vec2 d, vec2 from, vec2 to, inout float enter, inout float leave) {
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

float hitPrism(vec3 p, vec3 d, vec2 a, vec2 b, vec2 c, float halfDepth, float slack) {
    float enter = -NO_HIT;
    float leave = NO_HIT;
    hitEdge(p.xy, d.xy, a, b, enter, leave);
    hitEdge(p.xy, d.xy, b, c, enter, leave);
    hitEdge(p.xy, d.xy, c, a, enter, leave);
    if (abs(d.z) > 1e-12) {
        float middle = -p.z / d.z;
        float reach = halfDepth / abs(d.z);
        enter = max(enter, middle - reach);
        leave = min(leave, middle + reach);
    } else if (abs(p.z) >= halfDepth) {
        return NO_HIT;
    }
    return hitChord(enter, leave, slack);
}
