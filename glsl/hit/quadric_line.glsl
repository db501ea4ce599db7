// Where a t^2 + 2 b t + c goes from positive to negative, or NO_HIT: at its one root with
// negative growth, which is never the one that a wave leaves. Of the two ways to write that
// root the one that does not cancel is taken.
float fallingRoot(float a, float b, float c) {
    float under = b * b - a * c;
    if (under <= 0.0) {
        return NO_HIT;
    }
    float root = sqrt(under);
    if (b < 0.0) {
        // On its way in; a point that rounding put into the solid meets it at once.
        return max(c, 0.0) / (root - b);
    }
    return a < 0.0 ? (b + root) / -a : NO_HIT;
}
