// A gyroid of walls 0.48 m thick, as a user would write it: the value alone.
float field(vec3 p) {
    vec3 q = 1.25 * p;
    vec3 s = sin(q);
    vec3 c = cos(q);
    return (abs(dot(s, c.yzx)) - 0.3) / 1.25;
}
