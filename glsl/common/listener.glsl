// The listener: centre in metres, in the march's coordinates; radius.
uniform vec4 uListener;
// A copy of uListener (copyUniforms).
vec4 listener = vec4(0.0);
float squaredListenerRadius = 0.0;

float listenerDistance(vec3 p) {
    return length(p - listener.xyz) - listener.w;
}

// The next two functions are for profiles whose coordinates begin at the listener's centre.

// Distance to the listener if a wave along d can still meet it: a wave that moves away never does,
// and a wave that starts inside has arrived.
float sdListenerDirected(vec3 p, vec3 d) {
    const float NEVER = 1e30;
    float nearest = length(p) - listener.w;
    return nearest > 0.0 && dot(p, d) >= 0.0 ? NEVER : nearest;
}

// Hit of a ray with the listener; a wave that starts inside has arrived.
float hitListener(vec3 p, vec3 d) {
    float t = hitBall(p, d, squaredListenerRadius);
    return dot(p, p) <= squaredListenerRadius ? 0.0 : t;
}
