float opIntersection(float a, float b) { return max(a, b); }

vec4 opIntersection(vec4 a, vec4 b) { return a.w > b.w ? a : b; }

vec4 onLineIntersection(vec4 a, vec4 b) { return onLineComplement(onLineUnion(onLineComplement(a), onLineComplement(b))); }

vec4 onLineComplement(vec4 a) { return vec4(-a.xy, a.zw); }
