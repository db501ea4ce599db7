float opShell(float a, float halfThickness) { return abs(a) - halfThickness; }

vec4 opShell(vec4 a, float halfThickness) {
    return (a.w < 0.0 ? -a : a) - vec4(0.0, 0.0, 0.0, halfThickness);
}

vec4 onLineShell(vec4 a, float halfThickness) {
    return vec4(abs(a.x) - halfThickness, a.x < 0.0 ? -a.y : a.y, a.z, min(a.w, abs(a.x)));
}
