"""Prints each package of the workspace with each of its features alone, and without any: a line each, `PACKAGE FEATURE`
or `PACKAGE`. Reads what `cargo metadata --no-deps` writes."""

import json
import sys

for package in json.load(sys.stdin)["packages"]:
    for feature in ["", *sorted(set(package["features"]) - {"default"})]:
        print(f"{package['name']} {feature}".strip())
