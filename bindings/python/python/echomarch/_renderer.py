"""The choice of the OpenGL renderer, and of the program that tries users' GLSL."""

from __future__ import annotations

import os
import sys
from typing import List, Optional, Tuple

from . import _arguments, _echomarch

_chosen: Tuple[str, Optional[int]] = ("gl", None)


def use_renderer(gl: str = "gl", gpu: Optional[int] = None) -> None:
    """Choose the OpenGL interface and the device of all later calls of this process and of its workers.

    Parameters
    ----------
    gl : {"gl", "gles", "osmesa"}
        OpenGL 3.3 through EGL (WGL on Windows, CGL on macOS), OpenGL ES 3.0 through EGL, or Mesa's off-screen library.
    gpu : int, optional
        Number of the EGL device, from 0; the first that works by default.
    """
    global _chosen
    _arguments.text("gl", "the name of an OpenGL interface", gl)
    _arguments.optional_whole("gpu", "the number of a device, from 0", gpu)
    _echomarch.choose_renderer(gl, gpu)
    _chosen = (gl, gpu)
    _choose_field_trial()


def renderer() -> str:
    """Return the name of the OpenGL renderer. The first call opens OpenGL."""
    return _echomarch.renderer()


def chosen() -> Tuple[str, Optional[int]]:
    """Return the choice of :func:`use_renderer`."""
    return _chosen


def _choose_field_trial() -> None:
    """Let users' GLSL be tried by this Python in a child process.

    Without an interpreter (Python embedded in a program) nothing is chosen, and the library refuses users' GLSL.
    """
    if not sys.executable:
        return
    program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "_field_trial.py")
    gl, gpu = _chosen
    arguments: List[str] = [program, os.path.abspath(_echomarch.__file__), gl, "" if gpu is None else str(gpu)]
    _echomarch.choose_field_trial(sys.executable, arguments)


_choose_field_trial()
