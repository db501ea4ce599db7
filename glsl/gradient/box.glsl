// Away from the nearest point of the box, seen from outside; on a face its normal.
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

// Distance to a box that a wave along d can still meet, or NEVER. A wave that is beyond a face
// and does not come nearer to its plane never meets the box. Where rounding decides on which
// side of a face it is, it counts as beyond; a wave deeper in the box is beyond the nearest face.
float sdBoxAhead(vec3 p, vec3 d, vec4 halfSizeAndSlack) {
    const float NEVER = 1e30;
    vec3 away = vec3(p.x < 0.0 ? -d.x : d.x, p.y < 0.0 ? -d.y : d.y, p.z < 0.0 ? -d.z : d.z);
    vec3 beyond = abs(p) - halfSizeAndSlack.xyz;
    float furthest = max(beyond.x, max(beyond.y, beyond.z));
    float slack = halfSizeAndSlack.w;
    float face = furthest > slack ? 0.0 : min(furthest, -slack);
    vec3 receding = vec3(
        away.x >= 0.0 ? beyond.x : -NEVER,
        away.y >= 0.0 ? beyond.y : -NEVER,
        away.z >= 0.0 ? beyond.z : -NEVER);
    bool recedes = max(receding.x, max(receding.y, receding.z)) >= face;
    return recedes ? NEVER : length(max(beyond, 0.0)) + min(furthest, 0.0);
}
