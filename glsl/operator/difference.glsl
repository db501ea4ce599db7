float opDifference(float a, float b) { return max(a, -b); }
