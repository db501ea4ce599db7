"""Checks the links of a built site: each address within it names a file, and each anchor an element.

    python3 scripts/site/check_links.py FOLDER

Addresses of other sites are counted, not fetched. The pages of the folder `page` build their content by a script; only
their files are checked.
"""

import html.parser
import pathlib
import sys
import urllib.parse


class Page(html.parser.HTMLParser):
    """The links and the anchors of a page."""

    def __init__(self, text):
        super().__init__()
        self.links, self.anchors = [], set()
        self.feed(text)

    def handle_starttag(self, tag, attributes):
        for name, value in attributes:
            if name in ("href", "src") and value is not None:
                self.links.append(value)
            if name == "id" or (tag == "a" and name == "name"):
                self.anchors.add(value)


def check(folder):
    """Return sentences about broken links, and the numbers of links within and out of the site."""
    pages = {file.resolve(): Page(file.read_text(errors="replace")) for file in folder.rglob("*.html")}
    broken, within, outside = [], 0, 0
    for file, page in pages.items():
        for link in page.links:
            address = urllib.parse.urlsplit(link)
            if address.scheme or address.netloc:
                outside += address.scheme != "data"
                continue
            within += 1
            path = urllib.parse.unquote(address.path)
            target = (file.parent / path).resolve() if path else file
            if target.is_dir():
                target = target / "index.html"
            name = file.relative_to(folder)
            if not target.is_relative_to(folder) or not target.is_file():
                broken.append(f"{name}: {link} names no file of the site")
            elif address.fragment and target in pages and "page" not in target.relative_to(folder).parts:
                if urllib.parse.unquote(address.fragment) not in pages[target].anchors:
                    broken.append(f"{name}: {link} names no element of {target.relative_to(folder)}")
    return broken, within, outside


def main():
    folder = pathlib.Path(sys.argv[1]).resolve()
    broken, within, outside = check(folder)
    for sentence in broken:
        print(sentence, file=sys.stderr)
    if within == 0:
        sys.exit(f"{folder} has no links")
    print(f"{within} links within the site, {len(broken)} broken; {outside} links to other sites, not checked")
    sys.exit(1 if broken else 0)


if __name__ == "__main__":
    main()
