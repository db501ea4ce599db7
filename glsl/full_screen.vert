// One triangle that covers the whole viewport, computed from the vertex number: (-1, -1), (3, -1), (-1, 3). A
// fragment finds its texel by gl_FragCoord, without interpolated values.
void main() {
    vec2 corner = vec2(float((gl_VertexID & 1) << 2), float((gl_VertexID & 2) << 1));
    gl_Position = vec4(corner - 1.0, 0.0, 1.0);
}
