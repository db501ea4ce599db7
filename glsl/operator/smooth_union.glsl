// The polynomial smooth minimum (Quilez): a quarter of the radius lower where both are equal.
float opSmoothUnion(float a, float b, float radius) {
    float blend = max(radius - abs(a - b), 0.0);
    return min(a, b) - 0.25 * blend * blend / radius;
}
