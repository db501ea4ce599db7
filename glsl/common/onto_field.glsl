const int SHEETS = 3;         // maximum sheets of a surface that meet in a corner
const float APART = 64.0;     // offset from a sheet, in roundings, at which another sheet is the nearest

// Projects a point near a field's surface onto it: one Newton step along the gradient.
vec3 ontoField(vec3 q, vec4 gradientAndValue) {
    vec3 gradient = gradientAndValue.xyz;
    return q - gradient * (gradientAndValue.w / max(dot(gradient, gradient), 1e-30));
}

vec3 unitOrZero(vec3 v) {
    float size = length(v);
    return size > 0.0 ? v / size : vec3(0.0);
}

// The normal for a wave that moves along d: the normalised gradient. At an edge the gradient may point
// along d: the normal is then 0, and the wave keeps its direction.
vec3 facing(vec3 gradient, vec3 d) {
    return dot(gradient, d) < 0.0 ? unitOrZero(gradient) : vec3(0.0);
}
