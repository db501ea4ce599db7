// One iteration of the thesis' design, faithful to its figures 8 and 9.
//
// Kept on purpose: the start offset that is not stored; hits up to the minimum distance
// short of the surface; normals from differences of the whole scene's distance; waves
// that are dead are marched again from the origin with direction 0. Departures: the
// march has a step limit, and counters ride in the direction's last component.

uniform float uMinDistance;   // a surface counts as met below this distance, metres
uniform float uMaxDistance;   // a wave counts as dead beyond this, metres
uniform float uStartOffset;   // along the direction, metres
uniform float uNormalStep;    // of the central differences, metres
uniform int uStepLimit;       // evaluations in one march at the most

float minDistance = 0.0;
float maxDistance = 0.0;
int stepLimit = 0;

void copySettings() {
    minDistance = uMinDistance;
    maxDistance = uMaxDistance;
    stepLimit = uStepLimit;
}

// Figure 8: only waves that reached the listener stop.
bool finished(float status) {
    return reachedListener(status);
}

// Figure 9: how far the wave gets along its direction, or -1.
float traceWave(vec3 origin, vec3 direction, out float object, out bool limitReached) {
    float t = 0.0;
    limitReached = false;
    object = STATUS_DEAD;
    for (int i = 0; i < stepLimit; ++i) {
        if (!(t < maxDistance)) {
            return -1.0;
        }
        float nearest = distanceFunction(origin + t * direction, object);
        COUNT_EVALUATIONS(1.0);
        if (nearest < minDistance) {
            return t;
        }
        t += nearest;
    }
    limitReached = t < maxDistance;
    return -1.0;
}

// Hart 1996: the gradient by central differences, independent of the surface.
vec3 traceNormal(vec3 p) {
    vec2 e = vec2(uNormalStep, 0.0);
    float object;
    COUNT_EVALUATIONS(6.0);
    return normalize(vec3(
        distanceFunction(p + e.xyy, object) - distanceFunction(p - e.xyy, object),
        distanceFunction(p + e.yxy, object) - distanceFunction(p - e.yxy, object),
        distanceFunction(p + e.yyx, object) - distanceFunction(p - e.yyx, object)));
}

// Figure 8.
void iterate(inout vec4 origin, inout vec4 direction) {
    float object;
    bool limitReached;
    vec3 offset = direction.xyz * uStartOffset;
    float t = traceWave(origin.xyz + offset, direction.xyz, object, limitReached);
    vec3 hit = origin.xyz + t * direction.xyz;
    float counters = countPass(direction.w, t == 0.0, limitReached);
    if (t >= 0.0) {
        origin = vec4(hit, object);
        direction = vec4(reflect(direction.xyz, traceNormal(hit)), counters);
    } else {
        origin = vec4(0.0, 0.0, 0.0, STATUS_DEAD);
        direction = vec4(0.0, 0.0, 0.0, counters);
    }
}
