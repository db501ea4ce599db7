// The shading of a still picture: a lamp at the eye, a sky, a low sun, and the source itself; the last two cast soft
// shadows. In a closed room the walls block the sun, and the other lights remain.

const float FAR = 1000.0;           // metres; the sky lies beyond
const int VIEW_STEPS = 384;         // maximum number of evaluations for one ray
const int SHADOW_STEPS = 64;        // maximum number of evaluations for one shadow
const float CLOSE = 0.0005;         // distance in metres below which a ray has hit a surface
const float CLOSE_PIXELS = 0.25;    // the same as a share of a pixel's size at that distance
const int SAMPLES_PER_SIDE = 2;     // rays along each side of a pixel

// Visibility of a light at distance `far`: 1 in full sight, 0 if it is blocked; in between, by how closely
// the ray passes a surface.
float inSight(vec3 p, vec3 direction, float far, float sharpness) {
    float seen = 1.0;
    float t = 0.03;
    float object;
    for (int i = 0; i < SHADOW_STEPS; ++i) {
        if (t > far) {
            break;
        }
        float nearest = surfaceDistance(p + t * direction, object);
        seen = min(seen, sharpness * nearest / t);
        if (seen < 0.004) {
            return 0.0;
        }
        t += clamp(nearest, 0.02, 8.0);
    }
    seen = clamp(seen, 0.0, 1.0);
    return seen * seen * (3.0 - 2.0 * seen);
}

// Ambient occlusion: for points along the normal, by how much the nearest surface is closer than
// this one.
float openness(vec3 p, vec3 normal) {
    float blocked = 0.0;
    float weight = 0.5;
    float object;
    for (int i = 0; i < 5; ++i) {
        float h = 0.06 + 0.34 * float(i);
        float nearest = surfaceDistance(p + h * normal, object);
        blocked += weight * max(h - nearest, 0.0) / h;
        weight *= 0.72;
    }
    return clamp(1.0 - 0.62 * blocked, 0.0, 1.0);
}

// Coverage of a pixel of width w about x by lines of the given half width, one at every multiple of `spacing`:
// an exact box filter, so that distant lines blend instead of flickering.
vec3 lines(vec3 x, vec3 w, float spacing, float halfWidth) {
    vec3 width = max(w, vec3(1e-4)) / spacing;
    vec3 centre = x / spacing + halfWidth / spacing;
    vec3 to = centre + 0.5 * width;
    vec3 from = centre - 0.5 * width;
    float n = spacing / (2.0 * halfWidth);
    return (floor(to) + min(fract(to) * n, 1.0) - floor(from) - min(fract(from) * n, 1.0)) / (n * width);
}

// Strength (0 ... 1) of a one-metre grid on the surface at p, with every fifth line stronger.
float grid(vec3 p, vec3 normal, vec3 direction, float t) {
    float slant = dot(normal, direction);
    slant = slant < 0.0 ? min(slant, -0.02) : max(slant, 0.02);
    vec3 across = uRight - direction * (dot(normal, uRight) / slant);
    vec3 upward = uUp - direction * (dot(normal, uUp) / slant);
    vec3 w = t * uPixel * (abs(across) + abs(upward));
    // A plane on which a coordinate is constant shows no lines of that coordinate.
    vec3 along = smoothstep(vec3(0.05), vec3(0.3), sqrt(max(vec3(0.0), 1.0 - normal * normal)));
    vec3 fine = along * lines(p, w, 1.0, 0.012);
    vec3 coarse = along * lines(p, w, 5.0, 0.025);
    float f = max(fine.x, max(fine.y, fine.z));
    float c = max(coarse.x, max(coarse.y, coarse.z));
    return clamp(max(0.5 * f, c), 0.0, 1.0);
}

vec3 shade(vec3 p, vec3 direction, float t, float object) {
    vec3 normal = viewNormal(p, max(0.001, 0.5 * uPixel * t));
    vec3 base = surfaceColour(object, 0.83, 0.062);
    base *= 1.0 - 0.45 * grid(p, normal, direction, t);
    vec3 start = p + 0.004 * normal;
    float open = openness(start, normal);

    vec3 light = mix(vec3(0.26, 0.25, 0.25), vec3(0.46, 0.50, 0.54), 0.5 + 0.5 * normal.y);
    // A slight difference between walls that receive the same light.
    light *= 1.0 - 0.20 * normal.x + 0.10 * normal.z;
    float lamp = max(-dot(normal, direction), 0.0);
    float beam = dot(direction, uForward);
    light += 0.72 * lamp * beam * beam * beam / (1.0 + 0.005 * t * t);
    vec3 sun = normalize(SUN);
    float facing = dot(normal, sun);
    if (facing > 0.0) {
        light += 0.85 * facing * inSight(start, sun, 150.0, 24.0) * SUN_LIGHT;
    }
    vec3 toSource = uSource.xyz - p;
    float away = length(toSource);
    facing = dot(normal, toSource / max(away, 1e-4));
    if (facing > 0.0) {
        float reach = 1.6 / (1.0 + 0.02 * away * away);
        light += facing * reach * inSight(start, toSource / away, away, 14.0) * SOURCE_LIGHT;
    }
    return base * light * mix(0.25, 1.0, open);
}
