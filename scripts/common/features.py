"""Prints a line for each package of the workspace with each of its features alone (`PACKAGE FEATURE`) and without
features (`PACKAGE`). Reads the output of `cargo metadata --no-deps`."""

import json
import sys

for package in json.load(sys.stdin)["packages"]:
    for feature in ["", *sorted(set(package["features"]) - {"default"})]:
        print(f"{package['name']} {feature}".strip())
