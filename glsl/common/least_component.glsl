// The least and the greatest component, and the axis of the least.

float least(float v) { return v; }
float least(vec2 v) { return min(v.x, v.y); }
float least(vec3 v) { return min(v.x, min(v.y, v.z)); }
float greatest(float v) { return v; }
float greatest(vec2 v) { return max(v.x, v.y); }
float greatest(vec3 v) { return max(v.x, max(v.y, v.z)); }

// Returns 1 for the axis of the least component (the first of equal ones), and 0 for the others.
float atLeast(float v) { return 1.0; }
vec2 atLeast(vec2 v) { return v.x <= v.y ? vec2(1.0, 0.0) : vec2(0.0, 1.0); }
vec3 atLeast(vec3 v) {
    return v.x <= v.y && v.x <= v.z ? vec3(1.0, 0.0, 0.0) : vec3(0.0, atLeast(v.yz));
}
