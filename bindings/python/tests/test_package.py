"""The package as it is installed: files, types, documentation."""

import doctest
import importlib
import pathlib
import pkgutil
import subprocess
import sys

import pytest

import echomarch as em

REPOSITORY = pathlib.Path(__file__).resolve().parents[3]


def test_the_installed_wheel_is_tested():
    """Protects these tests: they use the installed package, not the folder of its sources."""
    assert "site-packages" in em.__file__, em.__file__
    assert (pathlib.Path(em.__file__).parent / "py.typed").exists()
    assert (pathlib.Path(em.__file__).parent / "_echomarch.pyi").exists()


def test_the_version_is_that_of_the_workspace():
    """Protects releases: package and program have one version."""
    assert f'version = "{em.__version__}"' in (REPOSITORY / "Cargo.toml").read_text()


def test_everything_public_is_documented():
    """Protects users of help(): each public name has a text, and each function names its parameters."""
    for name in em.__all__:
        value = getattr(em, name)
        if not callable(value):
            continue
        assert value.__doc__ and len(value.__doc__) > 20, name
        for member, inner in vars(value).items() if isinstance(value, type) else ():
            if not member.startswith("_") and (callable(inner) or isinstance(inner, (property, classmethod))):
                assert inner.__doc__ or getattr(inner, "__func__", inner).__doc__, f"{name}.{member}"


def test_the_examples_of_the_documentation_run():
    """Protects the examples in docstrings."""
    names = ["echomarch", *(f"echomarch.{module.name}" for module in pkgutil.iter_modules(em.__path__))]
    tried = 0
    for name in names:
        if name.endswith("_field_trial"):
            continue
        result = doctest.testmod(importlib.import_module(name), raise_on_error=False)
        assert result.failed == 0, name
        tried += result.attempted
    assert tried >= 8


def test_the_types_are_right(tmp_path):
    """Protects users of type checkers: the package itself, and a script that uses it, pass mypy --strict."""
    pytest.importorskip("mypy")
    script = tmp_path / "use.py"
    script.write_text(
        "import echomarch as em\n"
        "room = em.Scene.shoebox((8, 3, 5), absorption={'floor': 0.1})\n"
        "room.add_source('s', (0, 0, 0))\n"
        "found: em.Response = em.response(room, accuracy=0.02)\n"
        "samples = found.ir(format='stereo') * 2\n"
        "print(samples.shape, em.trace(room).pan + 1.0)\n"
    )
    package = pathlib.Path(em.__file__).parent
    for target in ([str(script)], ["-p", "echomarch"]):
        done = subprocess.run(
            [sys.executable, "-m", "mypy", "--strict", "--no-warn-unused-ignores", *target],
            capture_output=True,
            text=True,
            cwd=tmp_path,
        )
        assert done.returncode == 0, done.stdout + str(package)
