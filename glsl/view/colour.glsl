// Colours: one calm hue for each surface, and the conversion from linear light to the screen.

const float GOLDEN_ANGLE = 2.39996323;

// Linear RGB of a colour in Ottosson's Oklab, given by lightness, chroma and hue.
vec3 oklch(float lightness, float chroma, float hue) {
    float a = chroma * cos(hue);
    float b = chroma * sin(hue);
    vec3 lms = vec3(
        lightness + 0.3963377774 * a + 0.2158037573 * b,
        lightness - 0.1055613458 * a - 0.0638541728 * b,
        lightness - 0.0894841775 * a - 1.2914855480 * b);
    lms = lms * lms * lms;
    return max(vec3(0.0), vec3(
        4.0767416621 * lms.x - 3.3077115913 * lms.y + 0.2309699292 * lms.z,
        -1.2684380046 * lms.x + 2.6097574011 * lms.y - 0.3413193965 * lms.z,
        -0.0041960863 * lms.x - 0.7034186147 * lms.y + 1.7076147010 * lms.z));
}

// Consecutive numbers are a golden angle of hue apart, so that their colours differ clearly.
vec3 surfaceColour(float object, float lightness, float chroma) {
    return oklch(lightness, chroma, 1.25 + GOLDEN_ANGLE * (object - 1.0));
}

// sRGB's transfer function.
vec3 toScreen(vec3 light) {
    vec3 c = clamp(light, 0.0, 1.0);
    vec3 low = 12.92 * c;
    vec3 high = 1.055 * pow(max(c, vec3(1e-6)), vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThan(c, vec3(0.0031308))));
}
