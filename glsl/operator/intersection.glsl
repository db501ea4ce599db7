float opIntersection(float a, float b) { return max(a, b); }
