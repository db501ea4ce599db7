float opIntersection(float a, float b) { return max(a, b); }

vec4 opIntersection(vec4 a, vec4 b) { return a.w > b.w ? a : b; }

OnLine onLineIntersection(OnLine a, OnLine b) {
    return onLineComplement(onLineUnion(onLineComplement(a), onLineComplement(b)));
}
