// An infinite cylinder about y.

// Signed distance to a solid infinite cylinder about the y axis. Exact.
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

// Hit of a ray from outside with the infinite cylinder about y, computed as a hit with a circle in
// the xz plane.
float hitCircle(vec3 p, vec3 d, float squaredRadius) {
    vec3 heading = planeHeading(d);
    return enterCircle(p.xz, heading.xy, heading.z, squaredRadius);
}

// The direction of a line in the xz plane, and the inverse of its speed in that plane. A line practically
// parallel to the axis has the direction 0 and hits no circle.
vec3 planeHeading(vec3 d) {
    const float SLOWEST = 1e-12;
    float speed = length(d.xz);
    float inverseSpeed = 1.0 / max(speed, SLOWEST);
    return vec3(speed < SLOWEST ? vec2(0.0) : d.xz * inverseSpeed, inverseSpeed);
}

float enterCircle(vec2 p, vec2 heading, float inverseSpeed, float squaredRadius) {
    float along = dot(p, heading);
    vec2 aside = p - along * heading;
    float under = squaredRadius - dot(aside, aside);
    float t = max((-along - sqrt(max(under, 0.0))) * inverseSpeed, 0.0);
    return along < 0.0 && under > 0.0 ? t : NO_HIT;
}

float hitCylinder(vec3 p, vec3 d, float radius) {
    return hitCircle(p, d, radius * radius);
}

// Projects a hit point onto the cylinder, and returns the normal there.
void projectCylinder(inout vec3 p, float radius, out vec3 normal) {
    vec2 outward = normalize(p.xz);
    normal = vec3(outward.x, 0.0, outward.y);
    p.xz = normal.xz * radius;
}

// Distance to the cylinder, or NEVER for a wave along d that moves away from it.
float sdCylinderDirected(vec3 p, vec3 d, float radius) {
    const float NEVER = 1e30;
    return dot(p.xz, d.xz) >= 0.0 ? NEVER : length(p.xz) - radius;
}

float exitCylinder(vec3 p, vec3 d, float radius) {
    return exitRoot(dot(d.xz, d.xz), dot(p.xz, d.xz), dot(p.xz, p.xz) - radius * radius);
}

vec2 chordCylinder(vec3 p, vec3 d, float radius) {
    float a = dot(d.xz, d.xz);
    float middle = -dot(p.xz, d.xz) / max(a, 1e-12);
    vec2 nearest = p.xz + middle * d.xz;
    float under = radius * radius - dot(nearest, nearest);
    vec2 parallel = under > 0.0 ? vec2(-1e20, 1e20) : NO_CHORD;
    return a > 1e-12 ? chordAbout(middle, under / a) : parallel;
}
