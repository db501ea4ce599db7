float opUnion(float a, float b) { return min(a, b); }

vec4 opUnion(vec4 a, vec4 b) { return a.w < b.w ? a : b; }
