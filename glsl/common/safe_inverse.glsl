// The sign of each component of a direction: -1, or 1 for none.
vec3 headingSigns(vec3 d) {
    return vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
}

// Components of 0 are taken as a tiny number: what is divided by it lies far behind or far ahead,
// and nothing becomes a NaN.
vec3 notZero(vec3 sizes) {
    const float TINY = 1e-20;
    return max(sizes, TINY);
}

// How many metres of a line are a metre along each axis.
vec3 inverseSpeeds(vec3 d) {
    return 1.0 / notZero(abs(d));
}

vec3 safeInverse(vec3 d) {
    return headingSigns(d) * inverseSpeeds(d);
}
