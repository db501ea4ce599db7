float opMorph(float a, float b, float amount) { return mix(a, b, amount); }

vec4 opMorph(vec4 a, vec4 b, float amount) { return mix(a, b, amount); }

OnLine onLineMorph(OnLine a, OnLine b, float amount) {
    return OnLine(
        mix(a.value, b.value, amount),
        mix(a.slope, b.slope, amount),
        mix(a.sag, b.sag, amount),
        mix(a.rise, b.rise, amount),
        min(a.reach, b.reach));
}
