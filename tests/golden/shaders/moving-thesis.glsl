
// glsl/wave.glsl
// glsl/counters.glsl
// glsl/shape/torus.glsl
// the values of the surfaces
vec4 surfaceValue1 = vec4(0.0);

// glsl/operator/offset.glsl
// the surfaces
// surface 1 (Offset)
float field1(vec3 p) {
    float d1 = sdTorus(p, surfaceValue1.x, surfaceValue1.y);
    float d2 = opOffset(d1, 0.1);
    return d2;
}

// the values of the surfaces
vec4 surfaceValue0 = vec4(0.0);

// the scene's distance
// Signed distance to the nearest surface, and its number from 1.
float surfaceDistance(vec3 p, out float object) {
    // surface 1 (Offset)
    float nearest = field1(p - surfaceValue0.xyz);
    object = 1.0;
    return nearest;
}

// glsl/common/listener.glsl
// the scene and the listener
// Signed distance to the nearest surface or to the listener, whose number is 0.
float distanceFunction(vec3 p, out float object) {
    float nearest = surfaceDistance(p, object);
    float listener = listenerDistance(p);
    if (listener <= nearest) { nearest = listener; object = 0.0; }
    return nearest;
}

// glsl/iterate_thesis.glsl
// glsl/iterations.glsl
// glsl/common/listener.glsl
// the values of the surfaces
uniform vec4 uSurfaces[2];

// Copies for the loops: a driver may load a uniform again at each use.
void copyUniforms() {
    listener = uListener;
    squaredListenerRadius = listener.w * listener.w;
    surfaceValue0 = uSurfaces[0];
    surfaceValue1 = uSurfaces[1];
}

// glsl/iterate.frag
