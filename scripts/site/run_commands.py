"""Runs the commands of documents, so that no document shows a command that fails.

    python3 scripts/site/run_commands.py --in FOLDER [--python PYTHON] DOCUMENT.md …

A block ```sh is run by bash, line by line. The blocks ```python of a document are run as one script. A block ```ron or
```glsl is saved under the name in the sentence before it: "Save this as `room.ron`:". Blocks of other languages are not
run. Names of files are relative to FOLDER.
"""

import argparse
import pathlib
import re
import subprocess
import sys

BLOCK = re.compile(r"^```(sh|python|ron|glsl)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"Save\s+this\s+as\s+`([\w.-]+)`:\s*\Z")


def run(command, folder):
    """Run a command and end this program if it fails."""
    print(f"$ {' '.join(command)}", flush=True)
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{done.stdout}{done.stderr}the command failed with exit code {done.returncode}")


def run_document(document, folder, python):
    """Run the blocks of a document, and return their number."""
    text = document.read_text()
    script, count = [], 0
    for block in BLOCK.finditer(text):
        language, body = block.groups()
        if language in ("ron", "glsl"):
            named = NAMED.search(text[: block.start()])
            if named:
                (folder / named[1]).write_text(body)
        elif language == "sh":
            for line in body.splitlines():
                run(["bash", "-euc", line], folder)
                count += 1
        else:
            script.append(body)
            count += 1
    if script:
        file = folder / f"{document.stem}.py"
        file.write_text("\n".join(script))
        run([python, file.name], folder)
    return count


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--in", dest="folder", type=pathlib.Path, required=True)
    parser.add_argument("--python", default=sys.executable)
    parser.add_argument("documents", nargs="+", type=pathlib.Path)
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    for document in given.documents:
        count = run_document(document.resolve(), given.folder, given.python)
        if count == 0:
            sys.exit(f"{document} has no commands")
        print(f"{document}: {count} blocks and commands ran")


if __name__ == "__main__":
    main()
