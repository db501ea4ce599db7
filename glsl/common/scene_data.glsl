// The scene's data: a list of vectors in rows of 1024.
uniform highp sampler2D uSceneData;

vec4 sceneData(int index) {
    return texelFetch(uSceneData, ivec2(index & 1023, index >> 10), 0);
}
