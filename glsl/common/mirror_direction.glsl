// Specular reflection of a unit vector, normalised again because rounding would let its length drift over
// hundreds of reflections: one Newton step for the inverse square root, starting from 1.
vec3 mirror(vec3 direction, vec3 normal) {
    vec3 mirrored = direction - 2.0 * dot(normal, direction) * normal;
    return mirrored * (1.5 - 0.5 * dot(mirrored, mirrored));
}
