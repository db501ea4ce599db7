// The listener's view: sphere tracing (Hart 1996) with the distance function of the waves, shaded so that both a
// closed room and an open field are easy to read.

layout(location = 0) out vec4 outColour;

vec3 sky(vec3 direction) {
    float height = clamp(direction.y, 0.0, 1.0);
    return mix(vec3(0.74, 0.83, 0.88), vec3(0.14, 0.36, 0.66), pow(height, 0.55));
}

// Returns the distance along the ray to the first hit, or -1.
float traceView(vec3 eye, vec3 direction, out float object) {
    float t = 0.0;
    for (int i = 0; i < VIEW_STEPS; ++i) {
        float nearest = surfaceDistance(eye + t * direction, object);
        if (nearest < max(CLOSE, CLOSE_PIXELS * uPixel * t)) {
            return t;
        }
        t += nearest;
        if (t > FAR) {
            return -1.0;
        }
    }
    return t;
}

// Light of the source's ball and of the air around it, on a ray that ends at t.
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
    for (int y = 0; y < SAMPLES_PER_SIDE; ++y) {
        for (int x = 0; x < SAMPLES_PER_SIDE; ++x) {
            vec2 part = (vec2(float(x), float(y)) + 0.5) / float(SAMPLES_PER_SIDE) - 0.5;
            sum += look(gl_FragCoord.xy + part);
        }
    }
    float samples = float(SAMPLES_PER_SIDE * SAMPLES_PER_SIDE);
    outColour = vec4(toScreen(sum / samples), 1.0);
}
