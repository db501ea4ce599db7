// Diffuse reflection by Lambert's law: the density in a direction is proportional to its cosine with the normal.

// A random direction about the normal of a reflection that turned the wave by `turned`: the sum of the unit
// normal and a random point of the unit sphere has this distribution.
vec3 scattered(vec3 turned, vec3 mirrored, uvec3 bits) {
    const float LEAST = 1e-5;   // a shorter turn gives no normal, a shorter sum no direction
    float size = length(turned);
    vec3 normal = turned / max(size, LEAST);
    float share = unitInterval(bits.y);
    vec2 azimuth = cosineSineOfTurn(unitInterval(bits.z));
    float ring = 2.0 * sqrt(share * (1.0 - share));
    vec3 sum = normal + vec3(ring * azimuth.x, 1.0 - 2.0 * share, ring * azimuth.y);
    float far = length(sum);
    return size > LEAST && far > LEAST ? sum / far : mirrored;
}
