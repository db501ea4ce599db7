"""Runs Echomarch and other programs for a measurement, and reads their output."""

import json
import os
import re
import shutil
import subprocess
import sys
import time


def run(command, one_core=False):
    """The JSON that a program prints, and its peak memory in KiB.

    GNU time measures the memory, because the peak of a direct child of this process would include
    the memory of Python. Without GNU time the memory is unknown.
    """
    command = [str(word) for word in command]
    has_time = shutil.which("time") is not None
    if has_time:
        command = ["time", "--quiet", "-f", "%M", *command]
    environment = dict(os.environ)
    if one_core:
        command = ["taskset", "-c", str(max(os.sched_getaffinity(0))), *command]
        environment |= {"LP_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    ran = subprocess.run(command, env=environment, capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{ran.stderr}")
    return json.loads(ran.stdout), int(ran.stderr.split()[-1]) if has_time else None


def run_silently(command):
    """Runs a program and ignores its output."""
    command = [str(word) for word in command]
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode != 0:
        sys.exit(f"{' '.join(command)} failed:\n{ran.stderr}")


def trace(command, one_core=False, **options):
    """The JSON of a traced frame. `command` is the program with a subcommand and a scene. Options are the options of
    `echomarch trace`, with underscores: waves=65536, iterations_per_pass=1."""
    typed = [word for name, value in options.items() for word in ("--" + name.replace("_", "-"), value)]
    began = time.perf_counter()
    said, kibibytes = run([*command, *typed, "--json", "--quiet"], one_core)
    return {
        "seconds": time.perf_counter() - began,
        "milliseconds": said["milliseconds"],
        "heard": said["listener_hits"],
        "renderer": said["renderer"],
        "clock": said["clock"],
        "kibibytes": kibibytes,
    }


def slug(renderer):
    """A renderer's name as a part of a file's name: "llvmpipe (LLVM …)" becomes llvmpipe."""
    return re.sub(r"[^a-z0-9]+", "-", renderer.split("(")[0].lower()).strip("-") or "unknown"


def first_line(command):
    """The first line that a program prints."""
    try:
        ran = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    except OSError:
        return "not there"
    lines = ran.stdout.splitlines()
    return lines[0] if lines else "unknown"
