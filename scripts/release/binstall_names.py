"""Prints the file that cargo binstall downloads, and the program's path in it, for a target.

    cargo metadata --no-deps --format-version 1 | python3 scripts/release/binstall_names.py TARGET
"""

import json
import sys

packages = json.load(sys.stdin)["packages"]
package = next(package for package in packages if package["name"] == "echomarch-cli")
values = {
    "repo": package["repository"] or "",
    "version": package["version"],
    "target": sys.argv[1],
    "bin": "echomarch",
    "binary-ext": "",
}
for key in ("pkg-url", "bin-dir"):
    text = package["metadata"]["binstall"][key]
    for name, value in values.items():
        text = text.replace(f"{{ {name} }}", value)
    print(text.rsplit("/", 1)[-1] if key == "pkg-url" else text)
