float opShell(float a, float halfThickness) { return abs(a) - halfThickness; }

vec4 opShell(vec4 a, float halfThickness) {
    return (a.w < 0.0 ? -a : a) - vec4(0.0, 0.0, 0.0, halfThickness);
}
