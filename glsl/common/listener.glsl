// The listener: centre in metres, in the march's coordinates; radius.
uniform vec4 uListener;
// A copy of uListener (copyUniforms).
vec4 listener = vec4(0.0);
float squaredListenerRadius = 0.0;

float listenerDistance(vec3 p) {
    return length(p - listener.xyz) - listener.w;
}

// The next two functions are for profiles whose origin is the listener's centre.

// Distance to the listener, or NEVER for a wave along d that moves away from it. A wave that starts
// inside has already arrived.
float sdListenerDirected(vec3 p, vec3 d) {
    const float NEVER = 1e30;
    float nearest = length(p) - listener.w;
    return nearest > 0.0 && dot(p, d) >= 0.0 ? NEVER : nearest;
}

// Hit of a ray with the listener; a wave that starts inside has already arrived.
float hitListener(vec3 p, vec3 d) {
    float t = hitBall(p, d, squaredListenerRadius);
    return dot(p, p) <= squaredListenerRadius ? 0.0 : t;
}
