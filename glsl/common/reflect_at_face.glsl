// Reflects a wave at a face of an axis-aligned box, hit t metres ahead: moves p along d onto the face,
// and mirrors d. From inside (side 1) the face is the first of the three ahead whose plane the ray
// crosses; from outside (side -1), the last of the three that face the wave.
//
// Mirroring is an exact change of sign. A component of 0 becomes tiny, so that a wave in the plane of a
// wall hits the wall once and then leaves it.
void reflectAtFace(inout vec3 p, inout vec3 d, float t, vec3 centre, vec3 halfSize, float side) {
    vec3 heading = headingSigns(d);
    vec3 extent = side * halfSize;
    vec3 crossings = side * ((extent - heading * (p - centre)) * inverseSpeeds(d));
    bool isX = crossings.x <= min(crossings.y, crossings.z);
    bool isY = !isX && crossings.y <= crossings.z;
    bool isZ = !isX && !isY;
    vec3 hit = p + t * d;
    vec3 face = centre + heading * extent;
    vec3 mirrored = -heading * notZero(abs(d));
    p = vec3(isX ? face.x : hit.x, isY ? face.y : hit.y, isZ ? face.z : hit.z);
    d = vec3(isX ? mirrored.x : d.x, isY ? mirrored.y : d.y, isZ ? mirrored.z : d.z);
}
