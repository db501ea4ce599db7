float opDifference(float a, float b) { return max(a, -b); }

vec4 opDifference(vec4 a, vec4 b) { return a.w > -b.w ? a : -b; }

vec4 onLineDifference(vec4 a, vec4 b) { return onLineIntersection(a, onLineComplement(b)); }
