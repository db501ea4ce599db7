// 1 / v with components of 0 taken as a tiny number: what is divided by it lands far
// behind or far ahead, and nothing becomes a NaN.
vec3 safeInverse(vec3 v) {
    const float TINY = 1e-20;
    vec3 tiny = vec3(v.x < 0.0 ? -TINY : TINY, v.y < 0.0 ? -TINY : TINY, v.z < 0.0 ? -TINY : TINY);
    bvec3 small = lessThan(abs(v), vec3(TINY));
    return 1.0 / vec3(small.x ? tiny.x : v.x, small.y ? tiny.y : v.y, small.z ? tiny.z : v.z);
}
