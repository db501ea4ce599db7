"""Exceptions of the package. Their messages are those of the library and of the program."""

from __future__ import annotations


class EchomarchError(Exception):
    """Any error of this package."""


class SceneError(EchomarchError, ValueError):
    """A scene, or a file that it names, cannot be used."""


class SettingsError(EchomarchError, ValueError):
    """An argument is unknown, out of its range, or not of the type or shape that it takes."""


class SofaError(EchomarchError, ValueError):
    """A SOFA file cannot be read."""


class StudyError(EchomarchError, ValueError):
    """A study file, or a folder with its results, cannot be used."""


class RendererError(EchomarchError, RuntimeError):
    """OpenGL is missing, or fails."""


class ForkError(EchomarchError, RuntimeError):
    """The process was forked after OpenGL had been opened."""


class WorkerError(EchomarchError, RuntimeError):
    """A worker process ended without a result."""


class MissingPackageError(EchomarchError, ImportError):
    """An optional package is not installed."""


def needed(package: str, what: str) -> MissingPackageError:
    """Return the exception for a missing optional package."""
    return MissingPackageError(f"{what} needs the package {package}: python -m pip install {package}")
