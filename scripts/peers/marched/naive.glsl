// The tracer that a user would write: sphere tracing by the value to a millimetre, normals by six values,
// all iterations in one pass. The driver inserts `map`, the scene's distance, and the source and listener.
uniform sampler2D uDirections;
uniform int uIterations;
out vec4 end; // position; 0 heard, 1 travelling, -1 lost

const float MIN_DISTANCE = 1e-3;
const float START = 0.02; // of each flight, metres
const float OFFSET = 2e-3; // along the normal, metres

vec3 normalAt(vec3 p) {
    vec2 e = vec2(1e-3, 0.0);
    return normalize(vec3(
        map(p + e.xyy) - map(p - e.xyy),
        map(p + e.yxy) - map(p - e.yxy),
        map(p + e.yyx) - map(p - e.yyx)));
}

void main() {
    vec3 o = SOURCE;
    vec3 d = texelFetch(uDirections, ivec2(gl_FragCoord.xy), 0).xyz;
    end = vec4(o, 1.0);
    for (int i = 0; i < uIterations; ++i) {
        float t = START;
        vec3 p;
        for (int step = 0; step < 400; ++step) {
            p = o + t * d;
            float surface = map(p);
            float listener = length(p - LISTENER) - LISTENER_RADIUS;
            if (listener < MIN_DISTANCE) {
                end = vec4(p, 0.0);
                return;
            }
            if (surface < MIN_DISTANCE) {
                break;
            }
            t += min(surface, listener);
            if (t > 300.0) {
                break;
            }
        }
        end = vec4(p, 1.0);
        vec3 n = normalAt(p);
        o = p + OFFSET * n;
        d = reflect(d, n);
    }
}
