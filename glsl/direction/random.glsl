// Start directions: uniform over the sphere, one for each wave and seed.
//
// A counter-based hash (common/hash.glsl) gives each wave its own numbers without any state, so
// that the numbers depend only on wave and seed.

// Archimedes' theorem: height and azimuth are both uniform.
vec3 startDirection(uint wave, uint seed) {
    uvec3 bits = mixBits(uvec3(wave, seed, 0u));
    float share = unitInterval(bits.x);
    vec2 azimuth = cosineSineOfTurn(unitInterval(bits.y));
    // Equals sqrt(1 - height^2), which would lose digits near the poles.
    float ring = 2.0 * sqrt(share * (1.0 - share));
    return normalize(vec3(ring * azimuth.x, 1.0 - 2.0 * share, ring * azimuth.y));
}
