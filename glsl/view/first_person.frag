// What the listener sees: sphere tracing (Hart 1996) with the waves' own distance
// function, shaded so that a closed room and an open field both read well.
//
// Light: a lamp at the eye, a sky, a low sun, and the source itself, both of the latter
// with soft shadows. In a closed room the walls block the sun and the rest remains.

uniform vec3 uRight;      // unit vector out of the right ear
uniform vec3 uUp;         // unit vector out of the top of the head
uniform vec3 uForward;    // unit vector of the gaze
uniform vec4 uSource;     // centre in world metres, radius of the ball drawn
uniform vec2 uSize;       // of the picture in pixels
uniform float uPixel;     // size of a pixel one metre ahead, metres

layout(location = 0) out vec4 outColour;

const float FAR = 1000.0;        // metres; beyond lies the sky
const int VIEW_STEPS = 384;      // evaluations for one ray at the most
const int SHADOW_STEPS = 64;     // evaluations for one shadow at the most
const vec3 SUN = vec3(-0.48, 0.62, 0.62);
const vec3 SUN_LIGHT = vec3(1.0, 0.93, 0.80);
const vec3 SOURCE_LIGHT = vec3(1.0, 0.72, 0.38);

vec3 sky(vec3 direction) {
    float height = clamp(direction.y, 0.0, 1.0);
    return mix(vec3(0.74, 0.83, 0.88), vec3(0.14, 0.36, 0.66), pow(height, 0.55));
}

// How far the ray gets before it meets a surface, or -1.
float traceView(vec3 eye, vec3 direction, out float object) {
    float t = 0.0;
    for (int i = 0; i < VIEW_STEPS; ++i) {
        float nearest = surfaceDistance(eye + t * direction, object);
        if (nearest < max(0.0005, 0.25 * uPixel * t)) {
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

// 1 where a light that far away is in full sight, 0 where it is blocked; between, by how
// closely the ray passes a surface.
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

// Ambient occlusion: how much nearer the surfaces are than the way gone from this one.
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

// Share of lines of that half width, one at every multiple of `spacing`, over a pixel of
// width w about x: an exact box filter, so that far lines melt instead of flickering.
vec3 lines(vec3 x, vec3 w, float spacing, float halfWidth) {
    vec3 width = max(w, vec3(1e-4)) / spacing;
    vec3 centre = x / spacing + halfWidth / spacing;
    vec3 to = centre + 0.5 * width;
    vec3 from = centre - 0.5 * width;
    float n = spacing / (2.0 * halfWidth);
    return (floor(to) + min(fract(to) * n, 1.0) - floor(from) - min(fract(from) * n, 1.0)) / (n * width);
}

// Grid of metres on the surface at p, every fifth line stronger: 0 ... 1.
float grid(vec3 p, vec3 normal, vec3 direction, float t) {
    float slant = dot(normal, direction);
    slant = slant < 0.0 ? min(slant, -0.02) : max(slant, 0.02);
    vec3 across = uRight - direction * (dot(normal, uRight) / slant);
    vec3 upward = uUp - direction * (dot(normal, uUp) / slant);
    vec3 w = t * uPixel * (abs(across) + abs(upward));
    // A plane on which a coordinate is constant has no lines of it.
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
    // Some difference between walls that no light tells apart.
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

// Light of the source's ball and of the air about it, on a ray that ends at t.
vec3 addSource(vec3 colour, vec3 eye, vec3 direction, float t) {
    vec3 offset = uSource.xyz - eye;
    float ahead = dot(offset, direction);
    if (ahead <= 0.0 || ahead > t) {
        return colour;
    }
    float beside = length(offset - ahead * direction) / uSource.w;
    float edge = uPixel * ahead / uSource.w;
    float halo = exp(-1.1 * max(beside - 1.0, 0.0));
    colour += 0.55 * halo * SOURCE_LIGHT;
    float ball = 1.0 - smoothstep(1.0 - edge, 1.0 + edge, beside);
    float bulge = sqrt(max(0.0, 1.0 - beside * beside));
    return mix(colour, mix(vec3(1.6, 0.95, 0.30), vec3(3.2, 2.8, 2.0), bulge), ball);
}

vec3 look(vec2 pixel) {
    vec2 aim = (pixel - 0.5 * uSize) * uPixel;
    vec3 direction = normalize(uForward + aim.x * uRight + aim.y * uUp);
    vec3 eye = listener.xyz;
    float object;
    float t = traceView(eye, direction, object);
    vec3 colour = sky(direction);
    if (t >= 0.0) {
        vec3 haze = sky(vec3(direction.x, 0.0, direction.z));
        float clear = exp(-t / 220.0);
        colour = mix(haze, shade(eye + t * direction, direction, t, object), clear);
    }
    colour = addSource(colour, eye, direction, t < 0.0 ? FAR : t);
    return 1.0 - exp(-1.35 * colour);
}

void main() {
    copyUniforms();
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; ++i) {
        vec2 part = vec2(float(i & 1), float(i >> 1)) * 0.5 - 0.25;
        sum += look(gl_FragCoord.xy + part);
    }
    outColour = vec4(toScreen(0.25 * sum), 1.0);
}
