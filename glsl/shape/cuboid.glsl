// A box.

// Signed distance to a solid box about the origin. Exact on both sides.
float sdBox(vec3 p, vec3 halfSize) {
    vec3 beyond = abs(p) - halfSize;
    return length(max(beyond, 0.0)) + min(max(beyond.x, max(beyond.y, beyond.z)), 0.0);
}

// Outside, the direction from the nearest point of the box; else the normal of the nearest face.
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

// Hit of a ray from outside with a solid box: the slab method (Kay and Kajiya 1986). A start that rounding
// put into the box lies on the nearer end of the chord: at the entry the ray hits the box at once, at the
// exit not at all. A chord shorter than the error bound (of the box, and of the distance to it) is due to
// rounding and no hit.
float hitBox(vec3 p, vec3 d, vec4 halfSizeAndErrorBound) {
    return enterBox(p, headingSigns(d), inverseSpeeds(d), halfSizeAndErrorBound);
}

// The same hit, from the direction's signs and inverse speeds.
float enterBox(vec3 p, vec3 heading, vec3 inverse, vec4 halfSizeAndErrorBound) {
    vec3 ahead = heading * p;
    vec3 enters = (-halfSizeAndErrorBound.xyz - ahead) * inverse;
    vec3 leaves = (halfSizeAndErrorBound.xyz - ahead) * inverse;
    float enter = max(enters.x, max(enters.y, enters.z));
    float leave = min(leaves.x, min(leaves.y, leaves.z));
    return hitChord(enter, leave, halfSizeAndErrorBound.w);
}

// Projects a hit point onto the box, and returns the normal there: among the faces that face the direction
// d, that of the face that the point is furthest outside. A point on an edge or a vertex belongs to one of
// these faces, so the normal never points along d.
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

// Distance to the box, or NEVER if a wave along d cannot hit it. A wave that is beyond the plane of a face
// and does not approach this plane never hits the box. A wave within the error bound of a face counts as
// beyond it, and a wave deeper in the box as beyond the nearest face.
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

vec2 chordBox(vec3 p, vec3 d, vec3 halfSize) {
    vec3 inverse = safeInverse(d);
    vec3 a = (-halfSize - p) * inverse;
    vec3 b = (halfSize - p) * inverse;
    vec3 enters = min(a, b);
    vec3 leaves = max(a, b);
    return vec2(max(enters.x, max(enters.y, enters.z)), min(leaves.x, min(leaves.y, leaves.z)));
}
