"""Configuration of Sphinx for the site. scripts/site.sh stages the sources and runs Sphinx."""

import os
import pathlib
import re
import sys

from pygments.lexers.rust import RustLexer
from pygments.lexers.shell import BashLexer, BashSessionLexer
from pygments.token import Name, Text

project = "Echomarch"
copyright = "the Echomarch authors"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
include_patterns = [
    "*.md",
    "docs/*.md",
    "docs/benchmarks/*.md",
    "bindings/c/README.md",
    "adapters/*/README.md",
]
# Anchors of headings as on GitHub.
myst_heading_anchors = 4
# Documents begin with a heading of the first level in each part of a page. Constants of the Python package come from its
# compiled part, and are documented without their values.
suppress_warnings = ["myst.header", "misc.highlighting_failure", "autodoc.mocked_object"]

# The Python package is imported from its sources, without its compiled part and without NumPy.
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "bindings/python/python"))
autodoc_mock_imports = ["echomarch._echomarch", "numpy"]
autodoc_member_order = "bysource"
# The docstrings state types, with shapes and units.
autodoc_typehints = "none"
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_preprocess_types = False
# Single backquotes in docstrings mark parameters.
default_role = "literal"
add_module_names = False
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = "Echomarch"
html_static_path = ["_static"]
html_favicon = "_static/icon.svg"
html_css_files = ["site.css"]
# The page and the sounds, which are made before.
html_extra_path = ["extra"]
html_copy_source = False
html_show_sphinx = False

_LINK = re.compile(r"(!?)\[([^\]\[]*)\]\(([^)\s#]+)(#[^)]*)?\)")


class CommandLexer(BashLexer):
    """Commands of a shell. Words with a hyphen are marked, so that lines are not broken within them (site.css)."""

    def get_tokens_unprocessed(self, text):
        for index, token, value in super().get_tokens_unprocessed(text):
            if token is Text and "-" in value:
                token = Name.Attribute if value.startswith("-") else Name.Other
            yield index, token, value


class SessionLexer(BashSessionLexer):
    """Commands of a shell, with prompts."""

    _innerLexerCls = CommandLexer


def _with_links_of_the_site(app, docname, source):
    """Adapt links to the layout of the site.

    Links to folders of the repository become texts, because a site has no listing of folders. The pages of docs/site are
    at the root of the site.
    """
    root = pathlib.Path(app.srcdir)
    here = (root / docname).parent

    def adapted(link):
        if "://" in link[3]:
            return link[0]
        if (here / link[3]).is_dir():
            return link[2]
        target = os.path.normpath(here / link[3])
        page = os.path.relpath(target, root / "docs/site")
        if page.startswith(".."):
            return link[0]
        return f"{link[1]}[{link[2]}]({os.path.relpath(root / page, here)}{link[4] or ''})"

    source[0] = _LINK.sub(adapted, source[0])


def setup(app):
    # Scene files are highlighted like Rust.
    app.add_lexer("ron", RustLexer)
    app.add_lexer("sh", CommandLexer)
    app.add_lexer("console", SessionLexer)
    app.connect("source-read", _with_links_of_the_site)
