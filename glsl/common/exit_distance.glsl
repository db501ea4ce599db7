// Distance in metres at which a line leaves the convex solid that it begins in.

// The greater root of a t^2 + 2 b t + c with non-negative a.
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
