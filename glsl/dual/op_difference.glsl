vec4 opDifference(vec4 a, vec4 b) { return a.w > -b.w ? a : -b; }
