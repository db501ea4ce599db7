// The scene's data: an array of vectors. OpenGL has it in a buffer texture; ES 3.0, which has no buffer
// textures, in a 2D texture with rows of 1024 texels.
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
