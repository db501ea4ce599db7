"""Configuration of Sphinx for the site. scripts/site.sh stages the sources and runs Sphinx."""

import pathlib
import re

from pygments.lexers.rust import RustLexer

project = "Echomarch"
copyright = "the Echomarch authors"
extensions = ["myst_parser"]
root_doc = "index"
include_patterns = ["*.md", "docs/*.md", "docs/benchmarks/*.md"]
# Anchors of headings as on GitHub.
myst_heading_anchors = 4
# Documents begin with a heading of the first level in each part of a page.
suppress_warnings = ["myst.header", "misc.highlighting_failure"]

html_theme = "furo"
html_title = "Echomarch"
html_static_path = ["_static"]
html_css_files = ["site.css"]
# The page and the sounds, which are made before.
html_extra_path = ["extra"]
html_copy_source = False
html_show_sphinx = False

_LINK = re.compile(r"(!?)\[([^\]\[]*)\]\(([^)\s#]+)(#[^)]*)?\)")


def _without_links_to_folders(app, docname, source):
    """Replace links to folders of the repository by their text: a site has no listing of folders."""
    here = pathlib.Path(app.srcdir, docname).parent

    def text(link):
        return link[2] if "://" not in link[3] and (here / link[3]).is_dir() else link[0]

    source[0] = _LINK.sub(text, source[0])


def setup(app):
    # Scene files are highlighted like Rust.
    app.add_lexer("ron", RustLexer)
    app.connect("source-read", _without_links_to_folders)
