// Where a t^2 + 2 b t + c goes from positive to negative, or NO_HIT: at its one root with
// negative growth, which is never the one that a wave leaves. Of the two ways to write that
// root the one that does not cancel is taken. It may lie behind.
float fallingRoot(float a, float b, float c) {
    float under = b * b - a * c;
    if (under <= 0.0) {
        return NO_HIT;
    }
    float root = sqrt(under);
    if (b < 0.0) {
        return c / (root - b);
    }
    return a != 0.0 ? (b + root) / -a : NO_HIT;
}

// The way from p along d to where p is nearest to the origin: from there the numbers above are
// small, however far away p is, and their difference keeps its digits.
float wayToOrigin(vec3 p, vec3 d) {
    return max(-dot(p, d), 0.0);
}

// A root that was counted from that place. One behind the start is none, but for a start that
// rounding put into the solid (value) and that goes further in (growth).
float rootFrom(float way, float root, float value, float growth) {
    float t = way + root;
    if (t >= 0.0) {
        return min(t, NO_HIT);
    }
    return value < 0.0 && growth < 0.0 ? 0.0 : NO_HIT;
}
