// The polynomial smooth minimum (Quilez), a quarter of the radius below the minimum where both
// values are equal.
float opSmoothUnion(float a, float b, float radius) {
    float blend = max(radius - abs(a - b), 0.0);
    return min(a, b) - 0.25 * blend * blend / radius;
}

vec4 opSmoothUnion(vec4 a, vec4 b, float radius) {
    float blend = max(radius - abs(a.w - b.w), 0.0);
    float share = 0.5 * blend / radius;
    vec3 gradient = a.w < b.w ? mix(a.xyz, b.xyz, share) : mix(b.xyz, a.xyz, share);
    return vec4(gradient, min(a.w, b.w) - 0.25 * blend * blend / radius);
}

// Bound of the smooth union of two values: the blend's own second derivative is at least -(a' - b')^2
// / (2 radius), and both values grow by at most one metre per metre while their bounds hold.
vec4 blendAlong(vec4 a, vec4 b, float radius) {
    float blend = max(radius - abs(a.x - b.x), 0.0);
    float share = 0.5 * blend / radius;
    float slope = a.x < b.x ? mix(a.y, b.y, share) : mix(b.y, a.y, share);
    float steep = min((1.0 + a.y) / max(a.z, 1e-30), (1.0 + b.y) / max(b.z, 1e-30));
    float reach = min(min(a.w, b.w), max(steep, 0.0));
    return vec4(min(a.x, b.x) - 0.25 * blend * blend / radius, slope, max(a.z, b.z) + 2.0 / radius, reach);
}

// Bound of the smooth union's complement, from the bounds of the complements: a smooth maximum,
// whose blend curves upwards.
vec4 blendSolidAlong(vec4 a, vec4 b, float radius) {
    float blend = max(radius - abs(a.x - b.x), 0.0);
    float share = 0.5 * blend / radius;
    float slope = a.x > b.x ? mix(a.y, b.y, share) : mix(b.y, a.y, share);
    return vec4(max(a.x, b.x) + 0.25 * blend * blend / radius, slope, max(a.z, b.z), min(a.w, b.w));
}

// On a line: the blend subtracts (a' - b')^2 / (2 radius) from the second derivative, where both slopes are at most 1.
// Outside the blend only the lower value counts, as far as the values certainly stay apart.
OnLine onLineSmoothUnion(OnLine a, OnLine b, float radius) {
    float gap = abs(a.value - b.value);
    float blend = max(radius - gap, 0.0);
    float share = 0.5 * blend / radius;
    bool isFirst = a.value < b.value;
    float value = min(a.value, b.value) - 0.25 * blend * blend / radius;
    float slope = isFirst ? mix(a.slope, b.slope, share) : mix(b.slope, a.slope, share);
    vec3 low = isFirst ? vec3(a.sag, a.rise, a.reach) : vec3(b.sag, b.rise, b.reach);
    vec3 apart = vec3(low.xy, min(low.z, 0.5 * (gap - radius)));
    vec3 both = vec3(max(a.sag, b.sag) + 2.0 / radius, max(a.rise, b.rise), min(a.reach, b.reach));
    vec3 bend = apart.z > both.z ? apart : both;
    return OnLine(value, slope, bend.x, bend.y, bend.z);
}
