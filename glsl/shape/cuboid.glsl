// A box.

// Signed distance to a solid box about the origin. Exact on both sides.
float sdBox(vec3 p, vec3 halfSize) {
    vec3 beyond = abs(p) - halfSize;
    return length(max(beyond, 0.0)) + min(max(beyond.x, max(beyond.y, beyond.z)), 0.0);
}

// Direction from the nearest point of the box, seen from outside; on a face its normal.
vec3 gradientBox(vec3 p, vec3 halfSize) {
    vec3 side = vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
    vec3 beyond = abs(p) - halfSize;
    vec3 outside = max(beyond, 0.0);
    float apart = length(outside);
    if (apart > 0.0) {
        return side * outside / apart;
    }
    if (beyond.x >= beyond.y && beyond.x >= beyond.z) {
        return vec3(side.x, 0.0, 0.0);
    }
    return beyond.y >= beyond.z ? vec3(0.0, side.y, 0.0) : vec3(0.0, 0.0, side.z);
}

vec4 gdBox(vec3 p, vec3 halfSize) {
    return vec4(gradientBox(p, halfSize), sdBox(p, halfSize));
}

// Hit of a ray from outside with a solid box: the slab method (Kay and Kajiya 1986).
// A point that rounding put into the box lies on the nearer of the two faces along the line: on its way in
// it meets the box at once, on its way out not at all. A chord shorter than the error bound (the box's own,
// and that of the distance to it) is rounding and does not count.
float hitBox(vec3 p, vec3 d, vec4 halfSizeAndErrorBound) {
    return enterBox(p, headingSigns(d), inverseSpeeds(d), halfSizeAndErrorBound);
}

// The same, from the signs and the inverse speeds of the direction.
float enterBox(vec3 p, vec3 heading, vec3 inverse, vec4 halfSizeAndErrorBound) {
    vec3 ahead = heading * p;
    vec3 enters = (-halfSizeAndErrorBound.xyz - ahead) * inverse;
    vec3 leaves = (halfSizeAndErrorBound.xyz - ahead) * inverse;
    float enter = max(enters.x, max(enters.y, enters.z));
    float leave = min(leaves.x, min(leaves.y, leaves.z));
    return hitChord(enter, leave, halfSizeAndErrorBound.w);
}

// Puts a hit point onto the box, and returns the normal there: of the faces that face the direction d,
// that of the face the point is furthest outside of. An edge or a vertex belongs to one of its faces, so a
// normal never points along d.
void projectBox(inout vec3 p, vec3 d, vec3 halfSize, out vec3 normal) {
    vec3 side = vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
    vec3 beyond = abs(p) - halfSize;
    vec3 facing = -side * d;
    const float NEVER = -1e30;
    beyond = vec3(
        facing.x > 0.0 ? beyond.x : NEVER,
        facing.y > 0.0 ? beyond.y : NEVER,
        facing.z > 0.0 ? beyond.z : NEVER);
    if (beyond.x >= beyond.y && beyond.x >= beyond.z) {
        p.x = side.x * halfSize.x;
        normal = vec3(side.x, 0.0, 0.0);
    } else if (beyond.y >= beyond.z) {
        p.y = side.y * halfSize.y;
        normal = vec3(0.0, side.y, 0.0);
    } else {
        p.z = side.z * halfSize.z;
        normal = vec3(0.0, 0.0, side.z);
    }
}

// Distance to a box that a wave along d can still meet, or NEVER. A wave that is beyond a face and does not
// come nearer to its plane never meets the box. If rounding decides on which side of a face it is, it counts
// as beyond; a wave deeper in the box counts as beyond the nearest face.
float sdBoxDirected(vec3 p, vec3 d, vec4 halfSizeAndErrorBound) {
    const float NEVER = 1e30;
    vec3 away = vec3(p.x < 0.0 ? -d.x : d.x, p.y < 0.0 ? -d.y : d.y, p.z < 0.0 ? -d.z : d.z);
    vec3 beyond = abs(p) - halfSizeAndErrorBound.xyz;
    float furthest = max(beyond.x, max(beyond.y, beyond.z));
    float errorBound = halfSizeAndErrorBound.w;
    float face = min(furthest, -errorBound);
    vec3 receding = vec3(
        away.x >= 0.0 ? beyond.x : -NEVER,
        away.y >= 0.0 ? beyond.y : -NEVER,
        away.z >= 0.0 ? beyond.z : -NEVER);
    bool recedes = max(receding.x, max(receding.y, receding.z)) >= face;
    return recedes ? NEVER : length(max(beyond, 0.0)) + min(furthest, 0.0);
}

// Distance in metres at which a line leaves the box that it begins in.
float exitBox(vec3 p, vec3 d, vec3 halfSize) {
    vec3 within = vec3(d.x < 0.0 ? p.x : -p.x, d.y < 0.0 ? p.y : -p.y, d.z < 0.0 ? p.z : -p.z) + halfSize;
    vec3 way = within / max(abs(d), 1e-30);
    return min(way.x, min(way.y, way.z));
}
