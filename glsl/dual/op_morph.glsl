vec4 opMorph(vec4 a, vec4 b, float amount) { return mix(a, b, amount); }
