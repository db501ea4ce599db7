"""The Python environment of the peers, which scripts/peers.sh creates."""


def python(work):
    return work / "python/bin/python"


def has_package(work, name):
    """Whether the package was installed: the script then creates a file with the version in its name."""
    return any((work / "python").glob(f"has-{name}==*"))
