// A regular octahedron, by the distance to the nearest face's plane: the worked example of
// docs/architecture.md, built only for tests.

float sdOctahedron(vec3 p, float radius) {
    return (dot(abs(p), vec3(1.0)) - radius) * 0.57735027;
}

vec4 gdOctahedron(vec3 p, float radius) {
    vec3 side = vec3(p.x < 0.0 ? -1.0 : 1.0, p.y < 0.0 ? -1.0 : 1.0, p.z < 0.0 ? -1.0 : 1.0);
    return vec4(side * 0.57735027, sdOctahedron(p, radius));
}
