// What the listener sees while walking: as first_person.frag, but one ray a pixel, one
// short shadow and a glance at the corners, so that a processor without a graphics card
// draws it thirty times a second. The same light, so that both look alike.

uniform vec3 uRight;      // unit vector out of the right ear
uniform vec3 uUp;         // unit vector out of the top of the head
uniform vec3 uForward;    // unit vector of the gaze
uniform vec4 uSource;     // centre in world metres, radius of the ball drawn
uniform vec2 uSize;       // of the picture in pixels
uniform float uPixel;     // size of a pixel one metre ahead, metres

layout(location = 0) out vec4 outColour;

const float FAR = 400.0;         // metres; beyond lies the sky
const int VIEW_STEPS = 96;       // evaluations for one ray at the most
const int SHADOW_STEPS = 20;     // evaluations for the shadow at the most
const vec3 SUN = vec3(-0.48, 0.62, 0.62);
const vec3 SUN_LIGHT = vec3(1.0, 0.93, 0.80);
const vec3 SOURCE_LIGHT = vec3(1.0, 0.72, 0.38);

vec3 sky(vec3 direction) {
    float height = clamp(direction.y, 0.0, 1.0);
    return mix(vec3(0.74, 0.83, 0.88), vec3(0.14, 0.36, 0.66), sqrt(height));
}

// How far the ray gets before it meets a surface, or -1.
float traceView(vec3 eye, vec3 direction, out float object) {
    float t = 0.0;
    for (int i = 0; i < VIEW_STEPS; ++i) {
        float nearest = surfaceDistance(eye + t * direction, object);
        if (nearest < max(0.001, 0.4 * uPixel * t)) {
            return t;
        }
        t += nearest;
        if (t > FAR) {
            return -1.0;
        }
    }
    return t;
}

// The gradient by differences over a tetrahedron's corners.
vec3 viewNormal(vec3 p, float e) {
    const vec2 k = vec2(1.0, -1.0);
    float object;
    return normalize(
        k.xyy * surfaceDistance(p + e * k.xyy, object) +
        k.yyx * surfaceDistance(p + e * k.yyx, object) +
        k.yxy * surfaceDistance(p + e * k.yxy, object) +
        k.xxx * surfaceDistance(p + e * k.xxx, object));
}

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

// A grid of metres, every fifth line stronger, that melts with distance: 0 ... 1.
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

// Light of the source's ball and of the air about it, on a ray that ends at t.
vec3 addSource(vec3 colour, vec3 eye, vec3 direction, float t) {
    vec3 offset = uSource.xyz - eye;
    float ahead = dot(offset, direction);
    if (ahead <= 0.0 || ahead > t) {
        return colour;
    }
    float beside = length(offset - ahead * direction) / uSource.w;
    float edge = uPixel * ahead / uSource.w;
    colour += 0.55 * exp(-1.1 * max(beside - 1.0, 0.0)) * SOURCE_LIGHT;
    float ball = 1.0 - smoothstep(1.0 - edge, 1.0 + edge, beside);
    float bulge = sqrt(max(0.0, 1.0 - beside * beside));
    return mix(colour, mix(vec3(1.6, 0.95, 0.30), vec3(3.2, 2.8, 2.0), bulge), ball);
}

void main() {
    vec2 aim = (gl_FragCoord.xy - 0.5 * uSize) * uPixel;
    vec3 direction = normalize(uForward + aim.x * uRight + aim.y * uUp);
    vec3 eye = uListener.xyz;
    float object;
    float t = traceView(eye, direction, object);
    vec3 colour = sky(direction);
    if (t >= 0.0) {
        vec3 haze = sky(vec3(direction.x, 0.0, direction.z));
        colour = mix(haze, shade(eye + t * direction, direction, t, object), exp(-t / 220.0));
    }
    colour = addSource(colour, eye, direction, t < 0.0 ? FAR : t);
    outColour = vec4(toScreen(1.0 - exp(-1.35 * colour)), 1.0);
}
