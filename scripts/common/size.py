"""Counts the Rust files, lines and lines of code of docs/size.md, by its rule: comments, blank lines and tests are no
lines of code. Prints a row for each folder. `python3 scripts/common/size.py [COMMIT]`"""

import re
import subprocess
import sys

FOLDERS = [
    ("src/scene/",),
    ("src/shader/",),
    ("src/gl/",),
    ("src/tracer/",),
    ("src/response/", "src/hrtf/"),
    ("src/geometry/",),
    ("src/audio/",),
    ("src/auralisation/",),
    ("src/picture/",),
    ("src/simulator/",),
    ("src/offline/", "src/*.rs"),
    ("src/",),
    ("apps/cli/src/",),
    ("apps/lab/src/",),
    ("apps/walk/src/",),
    ("apps/window/src/",),
    ("apps/page/src/",),
    ("src/", "apps/*/src/"),
    ("bindings/python/src/",),
    ("bindings/c/src/", "bindings/c/header/"),
    ("adapters/*/src/",),
    ("src/", "apps/*/src/", "bindings/python/src/", "bindings/c/src/", "bindings/c/header/", "adapters/*/src/"),
]

# A comment or a literal, whichever begins first. A quote that begins a lifetime is neither.
TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*)|b?r(?P<hashes>\#*)".*?"(?P=hashes)|b?"(?:\\.|[^"\\])*"|b?'(?:\\.[^']*|[^'\\])'""",
    re.DOTALL,
)
# A module of tests in a file, up to its opening brace.
TESTS = re.compile(
    r"\#\[cfg\((?:test|all\(test,[^\]]*)\)\]\s* (?:\#\[[^\]]*\]\s*)* (?:pub(?:\([^)]*\))?\s+)? mod\s+\w+\s*\{",
    re.VERBOSE,
)


def end_of_comment(text, at):
    """The end of the block comment that begins at `at`; such comments nest."""
    depth = 0
    for mark in re.compile(r"/\*|\*/").finditer(text, at):
        depth += 1 if mark[0] == "/*" else -1
        if depth == 0:
            return mark.end()
    return len(text)


def without_comments(text):
    """The text without comments, and the same text with the contents of literals blank."""
    kept, bare, at = [], [], 0
    while token := TOKEN.search(text, at):
        between = text[at : token.start()]
        at = end_of_comment(text, token.start()) if token["comment"] == "/*" else token.end()
        literal = "" if token["comment"] else token[0]
        kept.append(between + literal)
        bare.append(between + re.sub(r"[^\n]", "_", literal))
    return "".join(kept) + text[at:], "".join(bare) + text[at:]


def code_lines(path, text):
    """The number of lines of code of a file."""
    if re.search(r"(^|/)tests(\.rs$|/)", path) or path == "src/test_common.rs":
        return 0
    kept, bare = without_comments(text)
    for block in reversed(list(TESTS.finditer(bare))):
        end, depth = block.end(), 1
        while depth > 0:
            depth += {"{": 1, "}": -1}.get(bare[end], 0)
            end += 1
        kept, bare = kept[: block.start()] + kept[end:], bare[: block.start()] + bare[end:]
    return sum(1 for line in kept.splitlines() if line.strip())


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def pattern(folder):
    """A pattern of the paths of a folder, or of its files alone."""
    inner = re.escape(folder).replace(r"\*", "[^/]*")
    return inner + ("$" if folder.endswith(".rs") else "")


def main():
    commit = sys.argv[1] if len(sys.argv) > 1 else "HEAD"
    paths = [path for path in run("git", "ls-tree", "-r", "--name-only", commit).splitlines() if path.endswith(".rs")]
    counts = {}
    for path in paths:
        if re.match("src/|apps/|bindings/|adapters/", path):
            text = run("git", "show", f"{commit}:{path}")
            counts[path] = (len(text.splitlines()), code_lines(path, text))
    for folders in FOLDERS:
        inside = [count for path, count in counts.items() if any(re.match(pattern(f), path) for f in folders)]
        lines, code = (sum(column) for column in zip(*inside))
        print(f"{', '.join(folders)} | {len(inside)} files, {lines:,} ({code:,})")


main()
