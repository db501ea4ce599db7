float opDifference(float a, float b) { return max(a, -b); }

vec4 opDifference(vec4 a, vec4 b) { return a.w > -b.w ? a : -b; }

OnLine onLineDifference(OnLine a, OnLine b) { return onLineIntersection(a, onLineComplement(b)); }
