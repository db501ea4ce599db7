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
