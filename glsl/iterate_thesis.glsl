// One iteration of the thesis' design, faithful to its figures 8 and 9.
//
// Properties of the thesis kept on purpose: the start offset is not stored; hits lie up to the minimum
// distance short of the surface; normals come from differences of the whole scene's distance; dead waves are
// marched again from the origin with direction 0. Departures: the march has a step limit, counters are
// stored in the direction's last component, and a wave dies where all differences are 0, because
// normalize(0) depends on the driver.

uniform float uMinDistance;   // a surface counts as hit below this distance, metres
uniform float uMaxDistance;   // a wave counts as dead beyond this, metres
uniform float uStartOffset;   // along the direction, metres
uniform float uNormalStep;    // of the central differences, metres
uniform int uStepLimit;       // maximum number of evaluations in one march

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

// Figure 9: returns the distance along the ray to the first hit, or -1.
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

// The gradient of the scene's distance by central differences (Hart 1996); 0 where the normal is
// undefined.
vec3 traceGradient(vec3 p) {
    vec2 e = vec2(uNormalStep, 0.0);
    float object;
    COUNT_EVALUATIONS(6.0);
    return vec3(
        distanceFunction(p + e.xyy, object) - distanceFunction(p - e.xyy, object),
        distanceFunction(p + e.yxy, object) - distanceFunction(p - e.yxy, object),
        distanceFunction(p + e.yyx, object) - distanceFunction(p - e.yyx, object));
}

// Figure 8.
void iterate(inout vec4 origin, inout vec4 direction) {
    float object;
    bool limitReached;
    vec3 offset = direction.xyz * uStartOffset;
    float t = traceWave(origin.xyz + offset, direction.xyz, object, limitReached);
    vec3 hit = origin.xyz + t * direction.xyz;
    float counters = countPass(direction.w, t == 0.0, limitReached);
    vec3 gradient = t >= 0.0 ? traceGradient(hit) : vec3(0.0);
    bool hasNormal = dot(gradient, gradient) > 0.0;
    // At the listener no normal is needed.
    if (hasNormal || (t >= 0.0 && reachedListener(object))) {
        vec3 mirrored = hasNormal ? reflect(direction.xyz, normalize(gradient)) : direction.xyz;
        origin = vec4(hit, object);
        direction = vec4(mirrored, counters);
    } else {
        origin = vec4(0.0, 0.0, 0.0, STATUS_DEAD);
        direction = vec4(0.0, 0.0, 0.0, counters);
    }
}
