"""Checks the built site: python docs/site/check.py [FOLDER].  Prints what is wrong and exits with 1.

Every file is read: no page, style or script loads anything from another host, and every link within the site leads to
a file and an anchor that exist.  Then pages are opened in Chromium (check_pages.mjs), where it and node are there.
"""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]

LOADING = {
    "audio": ("src",), "embed": ("src",), "iframe": ("src",), "img": ("src", "srcset"), "input": ("src",),
    "link": ("href",), "object": ("data",), "script": ("src",), "source": ("src", "srcset"), "track": ("src",),
    "video": ("src", "poster"), "image": ("href", "xlink:href"), "use": ("href", "xlink:href"),
}  # fmt: skip
"""Attributes by which an element loads something."""

HOST = re.compile(r"^\s*(?:https?:)?//", re.IGNORECASE)
IN_STYLE = re.compile(r"url\(\s*['\"]?\s*(?:https?:)?//|@import\s+['\"]\s*(?:https?:)?//", re.IGNORECASE)
IN_SCRIPT = re.compile(
    r"(?:fetch|importScripts|import|sendBeacon|WebSocket|EventSource|Worker)\s*\(\s*['\"`](?:https?:|wss?:)?//"
    r"|\.(?:src|href)\s*=\s*['\"`](?:https?:)?//"
    r"|\.open\(\s*['\"`]\w+['\"`]\s*,\s*['\"`](?:https?:)?//",
    re.IGNORECASE,
)
CDN = re.compile(r"cdn\.jsdelivr|unpkg\.com|cdnjs\.|googleapis|gstatic|polyfill\.io", re.IGNORECASE)


class Page(HTMLParser):
    """What a page loads, where its links lead, and its anchors."""

    def __init__(self, text: str) -> None:
        super().__init__(convert_charrefs=True)
        self.loads: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.styles: list[str] = []
        self.scripts: list[str] = []
        self.inside = ""
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note what the element says."""
        given = {name: value or "" for name, value in attrs}
        self.inside = tag if tag in ("style", "script") else ""
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        self.styles += [given["style"]] if "style" in given else []
        if tag == "link" and given.get("rel") in ("canonical", "author", "next", "prev"):
            return
        for name in LOADING.get(tag, ()):
            parts = given.get(name, "").split(",") if name == "srcset" else [given.get(name, "")]
            self.loads += [part.split()[0] for part in parts if part.strip()]
        if tag in ("a", "area") and "href" in given:
            self.links.append(given["href"])

    def handle_data(self, data: str) -> None:
        """Note styles and scripts that stand in the page."""
        if self.inside == "style":
            self.styles.append(data)
        elif self.inside == "script":
            self.scripts.append(data)

    def handle_endtag(self, tag: str) -> None:
        """Leave a style or a script."""
        self.inside = ""


@cache
def page(path: Path) -> Page:
    """A page, read once."""
    return Page(path.read_text(encoding="utf-8"))


def wrong_loads(site: Path) -> Iterator[str]:
    """What pages, styles and scripts load from another host."""
    for path in sorted(site.rglob("*")):
        name = path.relative_to(site).as_posix()
        if path.suffix in (".html", ".svg"):
            found = page(path)
            yield from (f"{name} loads {load}" for load in found.loads if HOST.match(load))
            yield from (f"{name}: a style loads from another host" for style in found.styles if IN_STYLE.search(style))
            yield from (f"{name}: a script loads from another host" for text in found.scripts if IN_SCRIPT.search(text))
        elif path.suffix == ".css" and IN_STYLE.search(path.read_text(encoding="utf-8")):
            yield f"{name} loads from another host"
        elif path.suffix in (".js", ".mjs") and path.name != "searchindex.js":
            text = path.read_text(encoding="utf-8")
            yield from (f"{name} loads from another host: {match[0]}" for match in IN_SCRIPT.finditer(text))
            yield from (f"{name} names {match[0]}" for match in CDN.finditer(text))


def wrong_links(site: Path) -> Iterator[str]:
    """Links and loads within the site that lead to no file, or to no anchor of it."""
    for path in sorted(site.rglob("*.html")):
        if path.relative_to(site).parts[0] == "rust":  # rustdoc checks its links itself
            continue
        for target in [*page(path).links, *page(path).loads]:
            if re.match(r"[a-zA-Z][\w+.-]*:|//", target):
                continue
            name, _, anchor = target.partition("#")
            name = unquote(name.split("?")[0])
            file = (path.parent / name).resolve() if name else path
            here = path.relative_to(site).as_posix()
            if file.is_dir():
                file = file / "index.html"
            if not file.is_file() or site not in file.parents:
                yield f"{here} leads to {target}, which does not exist"
            elif anchor and file.suffix == ".html" and unquote(anchor) not in page(file).anchors:
                yield f"{here} leads to {target}; there is no such anchor"


def check_files(site: Path) -> list[str]:
    """What is wrong with the files of a site."""
    if not (site / "index.html").is_file():
        return [f"there is no site in {site}: make docs"]
    return [*wrong_loads(site), *wrong_links(site)]


def chromium() -> bool:
    """Whether pages can be opened: Chromium, node, and the packages of web/package.json."""
    there = Path(os.environ.get("CHROMIUM", "/usr/bin/chromium")).exists() and shutil.which("node")
    return bool(there) and (ROOT / "web" / "node_modules" / "axe-core").is_dir()


def main() -> int:
    """Check the folder of the command line."""
    site = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "target" / "site" / "html").resolve()
    wrong = check_files(site)
    print(
        "\n".join(wrong)
        or f"files: {sum(1 for _ in site.rglob('*.html'))} pages, no load from another host, all links lead somewhere"
    )
    if wrong:
        return 1
    if not chromium():
        print("skipped: pages in Chromium (needs node, Chromium, and `npm ci` in web/)")
        return 0
    return subprocess.run(["node", str(HERE / "check_pages.mjs"), str(site)], check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
