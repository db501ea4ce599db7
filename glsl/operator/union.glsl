float opUnion(float a, float b) { return min(a, b); }

vec4 opUnion(vec4 a, vec4 b) { return a.w < b.w ? a : b; }

// On a line: the values may change places within half of their difference.
vec4 onLineUnion(vec4 a, vec4 b) {
    vec4 low = a.x < b.x ? a : b;
    return vec4(low.xyz, min(low.w, 0.5 * abs(a.x - b.x)));
}
