"""Names of the marched scenes and of their peers."""

NAMES = ["cave", "gyroid", "gyroid-gradient", "ground"]
ITERATIONS = 4
NAIVE = "60-line tracer, GLSL"
TWIN = "60-line tracer, C++ AVX2"
DESIGN = "design by the line, C++ AVX2"
SORTED = ", sorted starts"
EXACT = "exact"
