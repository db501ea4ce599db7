// Specular reflection of a unit vector, unit again: rounding would let its length drift
// over hundreds of reflections.
vec3 mirror(vec3 direction, vec3 normal) {
    return normalize(direction - 2.0 * dot(normal, direction) * normal);
}
