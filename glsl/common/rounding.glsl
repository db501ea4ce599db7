// Possible rounding error of a distance, in metres: a few units in the last place of the largest
// number in its computation, which is in the wave's position or in the surface's own position and size
// (the surface's error bound).

const float ROUNDING = 9.5367432e-7;   // 8 * 2^-23

float largest(vec3 v) {
    vec3 size = abs(v);
    return max(size.x, max(size.y, size.z));
}

float roundingAt(vec3 p, float errorBound) {
    return max(errorBound, ROUNDING * largest(p));
}

// The error bound of a ball or a cylinder, from its position and radius.
float roundErrorBound(vec4 placeAndRadius) {
    return ROUNDING * (largest(placeAndRadius.xyz) + placeAndRadius.w);
}
