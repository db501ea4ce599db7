"""The measurements of a run, stored in a file with one JSON object per line."""

import json


class Log:
    """`add` keeps the existing rows of the file; otherwise the file is replaced."""

    def __init__(self, file, add):
        self.file = file
        if not add:
            file.unlink(missing_ok=True)
        self.rows = [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []

    def record(self, row):
        self.rows.append(row)
        with self.file.open("a") as out:
            out.write(json.dumps(row) + "\n")

    def rounds(self, count):
        """The numbers of the next rounds."""
        first = 1 + max((row.get("round", 0) for row in self.rows), default=0)
        return range(first, first + count)


def chosen_scenes(parser, chosen, names):
    """Ends the program if a scene is unknown."""
    unknown = [name for name in chosen if name not in names]
    if unknown:
        parser.error(f"unknown scenes {' '.join(unknown)}: there are {' '.join(names)}")
