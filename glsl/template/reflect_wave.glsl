// Reflects a wave at the object that it hits t metres ahead: moves p along d onto the surface, and
// mirrors d.
void reflectWave(float object, float t, inout vec3 p, inout vec3 d) {
    vec3 from = p;
    vec3 along = d;
    vec3 hit = p + t * d;
    vec3 q;
    vec3 normal;
@met@@surfaces@@mirror@}

