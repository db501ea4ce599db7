const int SHEETS = 3;         // sheets of a surface that meet in a corner
const float APART = 64.0;     // distance from a sheet, in roundings, from which another one is the nearest

// One Newton step along the gradient: from a point next to a field's surface onto it.
vec3 ontoField(vec3 q, vec4 gradientAndValue) {
    vec3 gradient = gradientAndValue.xyz;
    return q - gradient * (gradientAndValue.w / max(dot(gradient, gradient), 1e-30));
}

vec3 unitOrZero(vec3 v) {
    float size = length(v);
    return size > 0.0 ? v / size : vec3(0.0);
}

// The unit normal of a gradient, for a wave that moves along d. At an edge the gradient may point along d:
// a wave that glances off there keeps its direction (a normal of 0).
vec3 facing(vec3 gradient, vec3 d) {
    return dot(gradient, d) < 0.0 ? unitOrZero(gradient) : vec3(0.0);
}
