// Diffuse reflection by Lambert's law: the density in a direction is proportional to the cosine of its angle to
// the normal.

// Returns a random direction about the surface normal, which is parallel to `turned`, the change of
// direction by specular reflection. The sum of the unit normal and a random point on the unit sphere has
// this distribution.
vec3 scattered(vec3 turned, vec3 mirrored, uvec3 bits) {
    const float LEAST = 1e-5;   // a shorter vector cannot be normalised
    float size = length(turned);
    vec3 normal = turned / max(size, LEAST);
    float share = unitInterval(bits.y);
    vec2 azimuth = cosineSineOfTurn(unitInterval(bits.z));
    float ring = 2.0 * sqrt(share * (1.0 - share));
    vec3 sum = normal + vec3(ring * azimuth.x, 1.0 - 2.0 * share, ring * azimuth.y);
    float far = length(sum);
    return size > LEAST && far > LEAST ? sum / far : mirrored;
}
