float opOffset(float a, float by) { return a - by; }
