// Signed distance to a quarter plane, from the distances to its two edge lines; and the weights of the
// gradients of these distances.
float sdCorner(vec2 beyond) {
    return length(max(beyond, 0.0)) + min(max(beyond.x, beyond.y), 0.0);
}

vec2 cornerShares(vec2 beyond) {
    vec2 outside = max(beyond, 0.0);
    float apart = length(outside);
    if (apart > 0.0) {
        return outside / apart;
    }
    return beyond.x >= beyond.y ? vec2(1.0, 0.0) : vec2(0.0, 1.0);
}
