float opUnion(float a, float b) { return min(a, b); }
