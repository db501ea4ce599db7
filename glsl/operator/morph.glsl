float opMorph(float a, float b, float amount) { return mix(a, b, amount); }

vec4 opMorph(vec4 a, vec4 b, float amount) { return mix(a, b, amount); }

vec4 onLineMorph(vec4 a, vec4 b, float amount) { return vec4(mix(a.xyz, b.xyz, amount), min(a.w, b.w)); }
