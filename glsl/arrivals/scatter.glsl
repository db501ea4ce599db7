// Diffuse reflection, by Lambert's law: as much into each angle as its cosine with the normal says.

// A direction about the normal along which a wave is turned: the sum of the unit normal and a point
// of the unit sphere is distributed so.
vec3 scattered(vec3 turned, vec3 mirrored, uvec3 bits) {
    const float LEAST = 1e-5;   // a turn less than that tells no normal; a sum has no direction
    float size = length(turned);
    vec3 normal = turned / max(size, LEAST);
    float share = unitInterval(bits.y);
    vec2 azimuth = cosineSineOfTurn(unitInterval(bits.z));
    float ring = 2.0 * sqrt(share * (1.0 - share));
    vec3 sum = normal + vec3(ring * azimuth.x, 1.0 - 2.0 * share, ring * azimuth.y);
    float far = length(sum);
    return size > LEAST && far > LEAST ? sum / far : mirrored;
}
