// Evaluates only a user's field: its value and its gradient at each point of a list.

uniform highp sampler2D uPoints;   // metres, in the axes of the field's box

layout(location = 0) out vec4 outValue;   // value, and gradient (0 without one)

void main() {
    vec3 p = texelFetch(uPoints, ivec2(gl_FragCoord.xy), 0).xyz;
    outValue = vec4(user0_field(p), checkedGradient(p));
}
