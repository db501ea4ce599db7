float opOffset(float a, float by) { return a - by; }

vec4 opOffset(vec4 a, float by) { return a - vec4(0.0, 0.0, 0.0, by); }

OnLine onLineOffset(OnLine a, float by) { return OnLine(a.value - by, a.slope, a.sag, a.rise, a.reach); }
