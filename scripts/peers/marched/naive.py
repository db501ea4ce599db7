"""Runs the 60-line tracer (naive.glsl) on a marched scene; called with the arguments of waves.h.

    naive.py SCENE DIRECTIONS ITERATIONS FRAMES ENDS
"""

import json
import sys
import time
from pathlib import Path

import moderngl

HERE = Path(__file__).resolve().parent
CORNERS = """#version 330
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    gl_Position = vec4(4.0 * corner - 1.0, 0.0, 1.0);
}"""
# Texels in a row of the textures.
WIDTH = 256
BYTES_IN_TEXEL = 16

GYROID = """
const vec3 SOURCE = vec3(-7.0, 1.0, -6.0);
const vec3 LISTENER = vec3(7.5, 1.0, 6.5);
const float LISTENER_RADIUS = 1.0;
const vec3 ROOM_HALF = vec3(9.0, 4.5, 8.0);
const vec3 FIELD_POSITION = vec3(1.0, -1.0, 1.0);
const vec3 FIELD_HALF = vec3(5.0, 3.0, 5.0);
const float GROWTH = 2.0;
"""
CONSTANTS = {
    "cave": """
const vec3 SOURCE = vec3(-8.0, -0.5, -1.5);
const vec3 LISTENER = vec3(6.0, 0.0, -2.0);
const float LISTENER_RADIUS = 1.0;
""",
    "gyroid": GYROID,
    "gyroid-gradient": GYROID,
    "ground": """
const vec3 SOURCE = vec3(-7.0, 2.5, -7.0);
const vec3 LISTENER = vec3(7.0, 1.0, 7.0);
const float LISTENER_RADIUS = 1.0;
const vec3 ROOM_HALF = vec3(11.0, 6.0, 11.0);
const vec3 FIELD_POSITION = vec3(0.0, -3.0, 0.0);
const vec3 FIELD_HALF = vec3(12.0, 4.0, 12.0);
const float GROWTH = 2.5;
""",
}
# A tracer that steps by values does not use a stated gradient.
MAPS = {
    "cave": ["cave.glsl"],
    "gyroid": ["gyroid.glsl", "box.glsl"],
    "gyroid-gradient": ["gyroid.glsl", "box.glsl"],
    "ground": ["ground.glsl", "box.glsl"],
}


def shader(scene):
    parts = ["#version 330", CONSTANTS[scene]]
    parts += [(HERE / name).read_text() for name in [*MAPS[scene], "naive.glsl"]]
    return "\n".join(parts)


def main():
    scene, directions, iterations, frames, ends = sys.argv[1:]
    starts = Path(directions).read_bytes()
    size = (WIDTH, len(starts) // (WIDTH * BYTES_IN_TEXEL))
    context = moderngl.create_context(
        standalone=True, backend="egl", libgl="libGL.so.1", libegl="libEGL.so.1", require=330
    )
    context.texture(size, 4, starts, dtype="f4").use()
    target = context.framebuffer([context.texture(size, 4, dtype="f4")])
    target.use()
    program = context.program(vertex_shader=CORNERS, fragment_shader=shader(scene))
    program["uIterations"] = int(iterations)
    waves = context.vertex_array(program, [])
    seconds = []
    for _ in range(1 + int(frames)):
        began = time.process_time()
        waves.render(vertices=3)
        found = target.read(components=4, dtype="f4")
        seconds.append(time.process_time() - began)
    Path(ends).write_bytes(found)
    print(json.dumps({"seconds": seconds[1:], "renderer": context.info["GL_RENDERER"]}))


if __name__ == "__main__":
    main()
