#!/usr/bin/env python3
"""Lists circular imports among the Rust files of the library and of each package in apps/, and among their folders.
The exit status is 1 if there are any.

A file imports another if one of its `use`s names an item defined there. A file and the folder of its submodules
(`cells.rs` and `cells/`) count as one module. Circles between a module and its parts are ignored. Tests are ignored as
well.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def module_of(path, source):
    parts = list(path.relative_to(source).with_suffix("").parts)
    if parts[-1] == "mod":
        parts.pop()
    return tuple(parts)


def is_test(path, source):
    parts = path.relative_to(source).with_suffix("").parts
    return "tests" in parts or path.name in ("lib.rs", "main.rs")


def without_tests(text):
    return re.split(r"#\[cfg\(test\)\]\s*mod tests \{", text)[0]


def expand(tree, head=()):
    """The paths of a use tree such as `super::{Medium, early::{A, B}}`."""
    tree = tree.strip()
    if "{" not in tree:
        words = [word.strip() for word in tree.split(" as ")[0].split("::")]
        yield head + tuple(word for word in words if word)
        return
    before, inside = tree.split("{", 1)
    inside = inside.rsplit("}", 1)[0]
    head = head + tuple(word.strip() for word in before.split("::") if word.strip())
    depth, start = 0, 0
    for at, letter in enumerate(inside + ","):
        depth += {"{": 1, "}": -1}.get(letter, 0)
        if letter == "," and depth == 0:
            if inside[start:at].strip():
                yield from expand(inside[start:at], head)
            start = at + 1


def absolute(path, module):
    if path[0] == "crate":
        return path[1:]
    if path[0] == "self":
        return module + path[1:]
    here = list(module)
    rest = list(path)
    while rest and rest[0] == "super":
        rest.pop(0)
        here = here[:-1]
    return tuple(here) + tuple(rest) if len(rest) < len(path) else module + path


class Sources:
    def __init__(self, source):
        files = [path for path in source.rglob("*.rs") if not is_test(path, source)]
        self.texts = {module_of(path, source): without_tests(path.read_text()) for path in files}
        self.public = {module: dict(self.reexports(module)) for module in self.texts}

    def uses(self, module, pattern):
        for tree in re.findall(pattern, self.texts[module], re.M | re.S):
            for path in expand(tree):
                yield absolute(path, module)

    def reexports(self, module):
        for path in self.uses(module, r"^\s*pub(?:\([a-z ]+\))? use ([^;]+);"):
            if path:
                yield path[-1], path

    def file_of(self, path, depth=0):
        """The module in whose file the last name of a path is defined."""
        for length in range(len(path), 0, -1):
            module = path[:length]
            if module not in self.texts:
                continue
            if length < len(path) and depth < 8:
                onward = self.public[module].get(path[length])
                if onward and onward != path:
                    return self.file_of(onward, depth + 1) or module
            return module
        return None

    def imports(self):
        found = {}
        for module in self.texts:
            targets = (self.file_of(path) for path in self.uses(module, r"^\s*use ([^;]+);"))
            found[module] = {to for to in targets if to is not None and not is_part(to, module)}
        return found


def is_part(one, other):
    """Whether one of two modules is the other or a part of it."""
    shorter = min(len(one), len(other))
    return one[:shorter] == other[:shorter]


def circles(imports):
    """The strongly connected components of more than one node (Tarjan 1972)."""
    order, low, stack, found = {}, {}, [], []

    def visit(node):
        order[node] = low[node] = len(order)
        stack.append(node)
        for to in sorted(imports.get(node, ())):
            if to not in order:
                visit(to)
            if to in stack:
                low[node] = min(low[node], low[to])
        if low[node] == order[node]:
            circle = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(circle) > 1:
                found.append(circle)

    for node in sorted(imports):
        if node not in order:
            visit(node)
    return found


def folders(imports, source):
    """The imports among the folders of a package's source, without single files such as error.rs."""
    found = {}
    for module, targets in imports.items():
        if (source / module[0]).is_dir():
            others = {to[:1] for to in targets if to[:1] != module[:1]}
            found.setdefault(module[:1], set()).update(to for to in others if (source / to[0]).is_dir())
    return found


def has_circles(source):
    """Whether a package has circular imports. Prints them."""
    imports = Sources(source).imports()
    found = False
    for what, graph in (("files", imports), ("folders", folders(imports, source))):
        for circle in circles(graph):
            found = True
            print(f"{what} of {source.relative_to(ROOT)} that import each other in a circle:")
            for node in circle:
                inside = sorted("/".join(to) for to in graph[node] if to in circle)
                print(f"  {'/'.join(node)} -> {', '.join(inside)}")
    return found


def main():
    sys.setrecursionlimit(10_000)
    sources = [ROOT / "src", *sorted(ROOT.glob("apps/**/src"))]
    # Every package is checked, even after a package with circles was found.
    return 1 if any([has_circles(source) for source in sources]) else 0


if __name__ == "__main__":
    sys.exit(main())
