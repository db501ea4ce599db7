// Reflects a wave at the object that it meets t ahead: p, from where it flies along d,
// becomes the point on the surface, and d is mirrored.
void reflectWave(float object, float t, inout vec3 p, inout vec3 d) {
    vec3 from = p;
    vec3 along = d;
    vec3 hit = p + t * d;
    vec3 q;
    vec3 normal;
@surfaces@
}

