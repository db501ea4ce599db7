// A ball.

// Signed distance to a solid ball about the origin. Exact.
float sdSphere(vec3 p, float radius) {
    return length(p) - radius;
}

vec3 gradientSphere(vec3 p) {
    return normalize(p);
}

vec4 gdSphere(vec3 p, float radius) {
    float apart = length(p);
    return vec4(p / max(apart, 1e-30), apart - radius);
}

float hitSphere(vec3 p, vec3 d, float radius) {
    return hitBall(p, d, radius * radius);
}

// Projects a hit point onto the ball, and returns the normal there.
void projectSphere(inout vec3 p, float radius, out vec3 normal) {
    normal = normalize(p);
    p = normal * radius;
}

// Distance to the ball, or NEVER for a wave along d that moves away from it.
float sdSphereDirected(vec3 p, vec3 d, float radius) {
    const float NEVER = 1e30;
    return dot(p, d) >= 0.0 ? NEVER : length(p) - radius;
}

float exitSphere(vec3 p, vec3 d, float radius) {
    return exitRoot(dot(d, d), dot(p, d), dot(p, p) - radius * radius);
}

vec3 bendSphere(vec4 gradient, vec3 p, float radius) { return bendOfDistance(gradient.w + radius); }

vec2 chordSphere(vec3 p, vec3 d, float radius) {
    float middle = -dot(p, d);
    vec3 nearest = p + middle * d;
    return chordAbout(middle, radius * radius - dot(nearest, nearest));
}
