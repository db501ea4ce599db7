// The scene's data: a list of vectors. In OpenGL a buffer of texels, addressed by the index alone; ES 3.0
// has none, and the data are rows of 1024 texels of a texture.
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
