// The scene's data: a list of vectors. In OpenGL a buffer of texels: nothing but the index is to be
// found of them. ES 3.0 has none: there they are in rows of 1024.
#ifdef GL_ES
uniform highp sampler2D uSceneData;
#else
uniform samplerBuffer uSceneData;
#endif

vec4 sceneData(int index) {
#ifdef GL_ES
    return texelFetch(uSceneData, ivec2(index & 1023, index >> 10), 0);
#else
    return texelFetch(uSceneData, index);
#endif
}
