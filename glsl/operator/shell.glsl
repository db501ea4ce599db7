float opShell(float a, float halfThickness) { return abs(a) - halfThickness; }

vec4 opShell(vec4 a, float halfThickness) {
    return (a.w < 0.0 ? -a : a) - vec4(0.0, 0.0, 0.0, halfThickness);
}

// On a line: the middle of the shell is a kink.
OnLine onLineShell(OnLine a, float halfThickness) {
    float toMiddle = abs(a.value);
    OnLine outer = a;
    if (a.value < 0.0) {
        outer = onLineComplement(a);
    }
    return OnLine(toMiddle - halfThickness, outer.slope, outer.sag, outer.rise, min(a.reach, toMiddle));
}
