"""Counts the operations of a shader for one wave from its SPIR-V.

`glslangValidator` compiles the shader that `echomarch` prints, and `spirv-opt -O` inlines all functions and removes
unused code. The count is the number of remaining instructions, each times the number of components of its result. Every
branch counts as taken, as on a renderer that runs lanes in parallel. The body of a loop counts once. For `hybrid`
without marched fields this body is one iteration.

Plain operations: add, multiply, compare, select, minimum, sign; a dot product of n components counts as
2n − 1, a fused multiply-add as 2. Special operations: division, root, sine and similar functions. Moves
and negations are free.
"""

import re
import shutil
import subprocess
import tempfile
from pathlib import Path

PLAIN = {
    "OpFAdd",
    "OpFSub",
    "OpFMul",
    "OpVectorTimesScalar",
    "OpSelect",
    "OpIAdd",
    "OpISub",
    "OpIMul",
    "OpBitwiseAnd",
    "OpBitwiseOr",
    "OpBitwiseXor",
    "OpShiftRightLogical",
    "OpShiftLeftLogical",
    "OpConvertSToF",
    "OpConvertUToF",
    "OpConvertFToS",
    "OpConvertFToU",
    "OpFMod",
}
SPECIAL = {"OpFDiv"}
# Plain operations per component of extended instructions. EXTENDED_SPECIAL lists those that are special.
EXTENDED = {
    "FMin": 1,
    "FMax": 1,
    "NMin": 1,
    "NMax": 1,
    "FClamp": 2,
    "NClamp": 2,
    "FSign": 1,
    "Floor": 1,
    "Round": 1,
    "Fract": 1,
    "FMix": 3,
    "Fma": 2,
    "Step": 1,
}
EXTENDED_SPECIAL = {"Sqrt", "InverseSqrt", "Sin", "Cos", "Tan", "Exp", "Exp2", "Log", "Pow", "Atan2", "Acos", "Asin"}


def of_shader(program, scene, options):
    """(plain, special, bytes fetched) of a shader; None if glslang or SPIRV-Tools is missing."""
    tools = ["glslangValidator", "spirv-opt", "spirv-dis"]
    if not all(shutil.which(tool) for tool in tools):
        return None
    with tempfile.TemporaryDirectory() as folder:
        source, binary, small = (Path(folder) / name for name in ("s.frag", "s.spv", "o.spv"))
        source.write_text(told([program, "shader", scene, *options]))
        told(["glslangValidator", "-G", "-S", "frag", "--aml", source, "-o", binary])
        told(["spirv-opt", "-O", binary, "-o", small])
        return count(told(["spirv-dis", "--no-header", small]))


def told(command):
    command = [str(word) for word in command]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def count(assembly):
    widths, plain, special, fetched = {}, 0, 0, 0
    for line in assembly.splitlines():
        words = re.sub(r'"[^"]*"', "", line).split()
        if len(words) < 3 or words[1] != "=":
            continue
        name, operation, operands = words[0], words[2], words[3:]
        if operation == "OpTypeVector":
            widths[name] = int(operands[1])
            continue
        width = widths.get(operands[0], 1) if operands else 1
        if operation in PLAIN or re.fullmatch(r"Op(F|U|S|I)(Ord|Unord)?(Less|Greater|Not|Equal)\w*", operation):
            plain += width
        elif operation in SPECIAL:
            special += width
        elif operation == "OpDot":
            # The line does not state the type of the vectors; they nearly always have three components.
            plain += 5
        elif operation == "OpImageFetch":
            fetched += 16
        elif operation == "OpExtInst":
            more = extended(operands[2], width)
            plain, special = plain + more[0], special + more[1]
    return plain, special, fetched


def extended(name, width):
    if name == "Normalize":
        return 3 * width - 1, 1
    if name in ("Length", "Distance"):
        return 5, 1
    if name == "Cross":
        return 9, 0
    if name in EXTENDED_SPECIAL:
        return 0, width
    return EXTENDED.get(name, 0) * width, 0
