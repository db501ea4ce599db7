// The way of a line through a union of boxes of air along the axes (src/shader/text/field/rooms.rs).
//
// A line that leaves a box stays in the air while another box contains the end of the way. The hit is the end of the
// last box.

float airBox = 0.0;   // number of the box that the line of the last hit left

// The distances along a line from p, where `ahead` is p in the signs of its heading, at which it enters a box that is
// grown by errorBound, and leaves the box itself. If the grown box contains p, up to errorBound beyond its faces,
// `begin` becomes at least the distance of the exit.
vec2 chordOfAir(vec3 from, vec3 to, vec3 ahead, vec3 heading, vec3 slowness, float errorBound, inout float begin) {
    vec3 a = heading * from;
    vec3 b = heading * to;
    float enter = greatest((min(a, b) - errorBound - ahead) * slowness);
    vec3 ways = (max(a, b) - ahead) * slowness;
    float leave = least(ways);
    bool contains = enter <= 0.0 && least(ways + errorBound * slowness) >= 0.0;
    begin = contains ? max(begin, leave) : begin;
    return vec2(enter, leave);
}

// Whether the line is in a box t metres ahead, and stays in it.
bool staysInAir(vec2 chord, float t) {
    return chord.x <= max(t, 0.0) && t < chord.y;
}

// Whether the line leaves a box t metres ahead.
bool leavesAir(vec2 chord, float t) {
    return chord.x <= max(t, 0.0) && t == chord.y;
}

// The point at which the line from p along d leaves a box, and the normal there, which points into the box. Sets the
// group of the face (src/scene/shape/rooms.rs).
void projectAirBox(vec3 p, vec3 d, vec3 from, vec3 to, out vec3 onto, out vec3 normal) {
    vec3 heading = headingSigns(d);
    vec3 face = vec3(d.x < 0.0 ? from.x : to.x, d.y < 0.0 ? from.y : to.y, d.z < 0.0 ? from.z : to.z);
    vec3 ways = heading * (face - p) * inverseSpeeds(d);
    float way = least(ways);
    onto = p + max(way, 0.0) * d;
    if (ways.x == way) {
        onto.x = face.x;
        normal = vec3(-heading.x, 0.0, 0.0);
        meshGroup = heading.x < 0.0 ? 0.0 : 1.0;
    } else if (ways.y == way) {
        onto.y = face.y;
        normal = vec3(0.0, -heading.y, 0.0);
        meshGroup = heading.y < 0.0 ? 2.0 : 3.0;
    } else {
        onto.z = face.z;
        normal = vec3(0.0, 0.0, -heading.z);
        meshGroup = heading.z < 0.0 ? 4.0 : 5.0;
    }
    meshGroup += 6.0 * airBox;
}
