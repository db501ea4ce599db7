float opOffset(float a, float by) { return a - by; }

vec4 opOffset(vec4 a, float by) { return a - vec4(0.0, 0.0, 0.0, by); }

vec4 onLineOffset(vec4 a, float by) { return vec4(a.x - by, a.yzw); }
