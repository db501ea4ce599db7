// Where a line leaves a convex solid that it begins in, in metres.

// The greater root of a t^2 + 2 b t + c, whose a is not negative.
float exitRoot(float a, float b, float c) {
    float root = sqrt(max(b * b - a * c, 0.0));
    if (b > 0.0) {
        return -c / (b + root);
    }
    return a > 0.0 ? (root - b) / a : NO_END;
}

float exitSlab(float y, float d, float halfHeight) {
    return ((d < 0.0 ? y : -y) + halfHeight) / max(abs(d), 1e-30);
}
