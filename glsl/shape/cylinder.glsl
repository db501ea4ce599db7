// An endless cylinder about y.

// Signed distance to a solid endless cylinder about the y axis. Exact.
float sdCylinder(vec3 p, float radius) {
    return length(p.xz) - radius;
}

vec3 gradientCylinder(vec3 p) {
    vec2 outward = normalize(p.xz);
    return vec3(outward.x, 0.0, outward.y);
}

vec4 gdCylinder(vec3 p, float radius) {
    float apart = length(p.xz);
    vec2 outward = p.xz / max(apart, 1e-30);
    return vec4(outward.x, 0.0, outward.y, apart - radius);
}

// Where a ray from outside meets the endless cylinder about y: the circle in the plane.
float hitCircle(vec3 p, vec3 d, float squaredRadius) {
    const float SLOWEST = 1e-12;   // below, the line is parallel to the axis for all that matters
    float speed = length(d.xz);
    float inverseSpeed = 1.0 / max(speed, SLOWEST);
    vec2 heading = d.xz * inverseSpeed;
    float along = dot(p.xz, heading);
    vec2 aside = p.xz - along * heading;
    float under = squaredRadius - dot(aside, aside);
    float t = max((-along - sqrt(max(under, 0.0))) * inverseSpeed, 0.0);
    return along < 0.0 && under > 0.0 && speed >= SLOWEST ? t : NO_HIT;
}

float hitCylinder(vec3 p, vec3 d, float radius) {
    return hitCircle(p, d, radius * radius);
}

// Puts a point that is met onto the cylinder, and says the normal there.
void projectCylinder(inout vec3 p, float radius, out vec3 normal) {
    vec2 outward = normalize(p.xz);
    normal = vec3(outward.x, 0.0, outward.y);
    p.xz = normal.xz * radius;
}

// Distance to a cylinder that a wave along d can still meet: one that it recedes from is never met.
float sdCylinderDirected(vec3 p, vec3 d, float radius) {
    const float NEVER = 1e30;
    return dot(p.xz, d.xz) >= 0.0 ? NEVER : length(p.xz) - radius;
}

float exitCylinder(vec3 p, vec3 d, float radius) {
    return exitRoot(dot(d.xz, d.xz), dot(p.xz, d.xz), dot(p.xz, p.xz) - radius * radius);
}
