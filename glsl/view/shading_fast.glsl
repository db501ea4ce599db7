// The shading while walking: one ray per pixel, one short shadow and two steps along the normal for corners, so that a
// processor without a graphics card draws thirty pictures per second. The lights are those of shading.glsl.

const float FAR = 400.0;            // metres; the sky lies beyond
const int VIEW_STEPS = 96;          // maximum number of evaluations for one ray
const int SHADOW_STEPS = 20;        // maximum number of evaluations for the shadow
const float CLOSE = 0.001;          // distance in metres below which a ray has hit a surface
const float CLOSE_PIXELS = 0.4;     // the same as a share of a pixel's size at that distance
const int SAMPLES_PER_SIDE = 1;     // rays along each side of a pixel

// 1 where the source is in full sight, 0 where it is blocked.
float inSight(vec3 p, vec3 direction, float far) {
    float seen = 1.0;
    float t = 0.05;
    float object;
    for (int i = 0; i < SHADOW_STEPS; ++i) {
        float nearest = surfaceDistance(p + t * direction, object);
        seen = min(seen, 14.0 * nearest / t);
        if (seen < 0.01) {
            return 0.0;
        }
        t += max(nearest, 0.05);
        if (t > far) {
            break;
        }
    }
    return clamp(seen, 0.0, 1.0);
}

// Strength (0 ... 1) of a one-metre grid that fades with distance, with every fifth line stronger.
float grid(vec3 p, vec3 normal, float t) {
    float width = clamp(1.6 * uPixel * t / max(0.08, abs(dot(normal, uForward))), 0.012, 4.0);
    vec3 along = step(vec3(0.3), sqrt(max(vec3(0.0), 1.0 - normal * normal)));
    vec3 fine = abs(fract(p + 0.5) - 0.5);
    vec3 coarse = abs(fract(0.2 * p + 0.5) - 0.5) * 5.0;
    vec3 f = along * clamp(1.0 - fine / width, 0.0, 1.0);
    vec3 c = along * clamp(1.0 - coarse / (1.7 * width), 0.0, 1.0);
    float thin = max(f.x, max(f.y, f.z)) * clamp(0.35 - width, 0.0, 0.35) / 0.35;
    float thick = max(c.x, max(c.y, c.z)) * clamp(1.6 - width, 0.0, 1.0);
    return clamp(max(0.5 * thin, 0.9 * thick), 0.0, 1.0);
}

vec3 shade(vec3 p, vec3 direction, float t, float object) {
    vec3 normal = viewNormal(p, max(0.002, 0.5 * uPixel * t));
    vec3 base = surfaceColour(object, 0.83, 0.062);
    base *= 1.0 - 0.45 * grid(p, normal, t);

    float other;
    float near = surfaceDistance(p + 0.25 * normal, other) / 0.25;
    float wide = surfaceDistance(p + 1.0 * normal, other);
    float open = clamp(0.25 + 0.35 * near + 0.4 * wide, 0.3, 1.0);

    vec3 light = mix(vec3(0.26, 0.25, 0.25), vec3(0.46, 0.50, 0.54), 0.5 + 0.5 * normal.y);
    light *= 1.0 - 0.20 * normal.x + 0.10 * normal.z;
    float lamp = max(-dot(normal, direction), 0.0);
    float beam = dot(direction, uForward);
    light += 0.72 * lamp * beam * beam * beam / (1.0 + 0.005 * t * t);
    light += 0.16 * max(dot(normal, normalize(SUN)), 0.0) * SUN_LIGHT;
    vec3 toSource = uSource.xyz - p;
    float away = length(toSource);
    float facing = dot(normal, toSource / max(away, 1e-4));
    if (facing > 0.0) {
        float reach = 1.6 / (1.0 + 0.02 * away * away);
        light += facing * reach * inSight(p + 0.01 * normal, toSource / away, away) * SOURCE_LIGHT;
    }
    return base * light * open;
}
