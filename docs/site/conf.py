"""Settings of Sphinx for the site; docs/site/build.py calls it, with the folder of the staged pages."""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from importlib.metadata import files
from pathlib import Path
from shutil import copy2
from typing import Any

from docutils import nodes
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx
from sphinx.environment import BuildEnvironment
from sphinx.util.logging import getLogger

sys.path.insert(0, str(Path(__file__).parent))

import name_pages
import search_words

import liepoisson as lp

HERE = Path(__file__).parent
logger = getLogger(__name__)

project = "liepoisson"
author = "The liepoisson developers"
project_copyright = f"2026, {author}"
version = release = lp.__version__

extensions = ["myst_parser", "sphinx.ext.mathjax"]
myst_enable_extensions = ["dollarmath", "amsmath", "deflist", "colon_fence", "attrs_inline"]
myst_fence_as_directive = ["math"]
myst_heading_anchors = 6
myst_dmath_double_inline = True
suppress_warnings = ["myst.header"]  # tables of benchmarks are headed one level lower than what is before them
source_suffix = {".md": "markdown"}

smartquotes = False  # an option is --start, and a value "not finite"
nitpicky = True
# Types of other libraries have no entry here; those of liepoisson must have one.
nitpick_ignore_regex = [(r"py:.*", r"(?!lp\.|liepoisson\.).*")]
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 80
toc_object_entries = True
toc_object_entries_show_parents = "hide"

html_theme = "furo"
html_title = f"liepoisson {version}"
html_static_path = [str(HERE / "static")]
html_css_files = ["site.css"]
html_js_files = ["site.js"]
html_favicon = str(HERE / "static" / "icon.svg")
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
html_theme_options: dict[str, Any] = {"navigation_with_keys": True, "top_of_page_buttons": []}
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "a11y-high-contrast-dark"

mathjax_path = "mathjax/startup.js"
mathjax3_config = {
    # The parts by themselves: the whole program has addresses of other hosts in it, for menus and speech.
    "loader": {"load": ["input/tex", "output/chtml", "a11y/assistive-mml"]},
    "chtml": {"matchFontHeight": False, "mtextInheritFont": True},
    "tex": {"packages": {"[-]": ["noerrors", "noundefined"]}},
}
MATHJAX = re.compile(
    r"static/mathjax/((?:startup|core|loader|input/tex|output/chtml|a11y/assistive-mml)\.js"
    r"|output/chtml/fonts/(?:tex\.js|woff-v2/.*)|input/tex/extensions/.*)$"
)
"""What of MathJax the pages need: the program, its fonts, and what it loads when a formula asks for it."""


def copy_mathjax(app: Sphinx, _: Exception | None) -> None:
    """Put MathJax beside the pages, from the package that carries it."""
    for file in files("sphinx-mathjax-offline") or []:
        if match := MATHJAX.search(file.as_posix()):
            place = Path(app.outdir) / "_static" / "mathjax" / match[1]
            place.parent.mkdir(parents=True, exist_ok=True)
            copy2(str(file.locate()), place)


def add_search(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """The page of results ranks pages by scripts of its own."""
    if page == "search":
        app.add_js_file("search_words.js")
        app.add_js_file("search.js")


def check_search(app: Sphinx, env: BuildEnvironment) -> None:
    """The table of words names pages that exist."""
    for page in sorted(search_words.unknown(env.found_docs)):
        logger.warning("docs/site/search_words.py names a page that the site does not have: %s", page)


def write_search_words(app: Sphinx, _: Exception | None) -> None:
    """Put the table of words beside the scripts."""
    search_words.write(Path(app.outdir) / "_static")


def link_names(app: Sphinx, document: nodes.document) -> None:
    """Code that is a public name, with or without a call behind it, leads to its entry."""
    page = app.env.docname
    in_reference = page.startswith("reference/")
    for literal in list(document.findall(nodes.literal)):
        parent = literal.parent
        if literal.children[1:] or any(
            isinstance(one, nodes.reference | pending_xref | nodes.title) for one in above(literal)
        ):
            continue
        match = re.match(r"(lp(?:\.\w+)+|[A-Za-z]\w*(?:\.\w+)?)(\(.*\))?$", literal.astext(), re.DOTALL)
        if match is None or not (match[1].startswith("lp.") or in_reference):
            continue
        target = target_of(match[1])
        if target is not None and not page.endswith(target.page):
            link = pending_xref(
                "", refdomain="py", reftype="obj", reftarget=full_name(match[1], target), refexplicit=True, refwarn=True
            )
            link["refdoc"] = page
            parent.replace(literal, link)
            link += literal


def above(node: nodes.Node) -> Iterator[nodes.Node]:
    """The nodes that a node is in."""
    while (node := node.parent) is not None:
        yield node


def target_of(dotted: str) -> name_pages.Name | None:
    """The public name that begins a dotted one."""
    parts = dotted.split(".")
    for end in range(len(parts), 0, -1):
        if (found := name_pages.spoken().get(".".join(parts[:end]))) is not None:
            return found
    return None


def full_name(dotted: str, target: name_pages.Name) -> str:
    """The entry of a dotted name: that of a member if it has one."""
    for known in (target.long, target.short, target.name):
        if dotted.startswith(f"{known}."):
            member = dotted.removeprefix(f"{known}.").split(".")[0]
            if isinstance(target.value, type) and member in dict(name_pages.members_of(target.value)):
                return f"{target.short}.{member}"
    return target.short


def accessible(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """What scrolls sideways can be reached by the keyboard, and elements say what they are."""
    if "furo_navigation_tree" in context:
        tree = context["furo_navigation_tree"]
        context["furo_navigation_tree"] = tree.replace('role="heading"', 'role="heading" aria-level="2"')
    if "body" in context:
        body = context["body"]
        body = re.sub(r'<div class="(table-wrapper|math notranslate)', r'<div tabindex="0" class="\1', body)
        body = body.replace("<pre>", '<pre tabindex="0">')
        body = re.sub(r'<th class="head[^"]*">(?:<p>\s*</p>)?</th>', "<td></td>", body)
        context["body"] = LINES_OF_SIGNATURE.sub(lambda found: _as_lines(found[1]), body)


LINES_OF_SIGNATURE = re.compile(r"<dl>\s*((?:<dd>(?:(?!</?d[dlt]>).)*</dd>\s*)+)</dl>", re.DOTALL)
"""The parameters of a long signature, which Sphinx writes as definitions of nothing."""


def _as_lines(parameters: str) -> str:
    lines = parameters.replace("<dd>", '<span class="sig-line">').replace("</dd>", "</span>")
    return f'<span class="sig-lines">{lines}</span>'


def name_landmarks(app: Sphinx, error: Exception | None) -> None:
    """The sidebars of the theme have names, and the page of search results a heading, for those who do not see them."""
    for path in Path(app.outdir).rglob("*.html") if error is None else ():
        text = path.read_text(encoding="utf-8")
        text = text.replace('<aside class="sidebar-drawer"', '<aside aria-label="Contents" class="sidebar-drawer"')
        text = text.replace('<aside class="toc-drawer', '<aside aria-label="On this page" class="toc-drawer')
        if path.name == "search.html":
            text = text.replace('<div id="search-results">', '<h1>Search</h1>\n<div id="search-results">')
        path.write_text(text, encoding="utf-8")


def short_sidebar(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: Any) -> None:
    """The table of contents opens the branch of the page, and not hundreds of names on each page."""
    if (whole := context.get("toctree")) is not None:
        context["toctree"] = lambda **options: whole(**{**options, "collapse": True})


def setup(app: Sphinx) -> None:
    """Connect what is above."""
    app.connect("html-page-context", short_sidebar, priority=100)
    app.connect("doctree-read", link_names)
    app.connect("html-page-context", accessible, priority=900)
    app.connect("html-page-context", add_search)
    app.connect("env-check-consistency", check_search)
    app.connect("build-finished", copy_mathjax)
    app.connect("build-finished", write_search_words)
    app.connect("build-finished", name_landmarks)
