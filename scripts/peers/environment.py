"""The Python environment of the peers, which scripts/peers.sh makes."""


def python(work):
    return work / "python/bin/python"


def has_package(work, name):
    """Whether the package was installed: the script then leaves a file, with the version in its name."""
    return any((work / "python").glob(f"has-{name}==*"))
