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

// On a line: the blend adds (a' - b')^2 / (2 radius) to the second derivative, where both slopes are at most 1. Outside
// the blend only the lower value counts, as far as the values certainly stay apart.
vec4 onLineSmoothUnion(vec4 a, vec4 b, float radius) {
    float gap = abs(a.x - b.x);
    float blend = max(radius - gap, 0.0);
    float share = 0.5 * blend / radius;
    vec4 low = a.x < b.x ? a : b;
    vec4 high = a.x < b.x ? b : a;
    vec2 valueAndSlope = vec2(low.x - 0.25 * blend * blend / radius, mix(low.y, high.y, share));
    vec2 apart = vec2(low.z, min(low.w, 0.5 * (gap - radius)));
    vec2 both = vec2(max(a.z, b.z) + 2.0 / radius, min(a.w, b.w));
    return vec4(valueAndSlope, apart.y > both.y ? apart : both);
}
