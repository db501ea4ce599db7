"""The child process in which users' GLSL is tried. Its limits protect the process that uses the scene.

This file is started as a program with the path of the extension module. It does not import the package, so that the
child starts quickly.
"""

import importlib.util
import sys


def main() -> int:
    """Answer the request on standard input."""
    _, module, api, gpu = sys.argv
    spec = importlib.util.spec_from_file_location("_echomarch", module)
    assert spec is not None and spec.loader is not None
    extension = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(extension)
    return 0 if extension.answer_field_trial(api, int(gpu) if gpu else None) else 1


if __name__ == "__main__":
    sys.exit(main())
