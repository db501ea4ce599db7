// The sign of each component of a direction: -1, or 1 for 0 and above.
vec3 headingSigns(vec3 d) {
    return vec3(d.x < 0.0 ? -1.0 : 1.0, d.y < 0.0 ? -1.0 : 1.0, d.z < 0.0 ? -1.0 : 1.0);
}

// Replaces components of 0 by a tiny number: dividing by one gives a huge number and never NaN.
vec3 notZero(vec3 sizes) {
    const float TINY = 1e-20;
    return max(sizes, TINY);
}

// Distance along a line per metre along each axis.
vec3 inverseSpeeds(vec3 d) {
    return 1.0 / notZero(abs(d));
}

vec3 safeInverse(vec3 d) {
    return headingSigns(d) * inverseSpeeds(d);
}
