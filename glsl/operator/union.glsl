float opUnion(float a, float b) { return min(a, b); }

vec4 opUnion(vec4 a, vec4 b) { return a.w < b.w ? a : b; }

// On a line: the values may change places within half of their difference.
OnLine onLineUnion(OnLine a, OnLine b) {
    float apart = 0.5 * abs(a.value - b.value);
    OnLine low = b;
    if (a.value < b.value) {
        low = a;
    }
    low.reach = min(low.reach, apart);
    return low;
}
