float opMorph(float a, float b, float amount) { return mix(a, b, amount); }
