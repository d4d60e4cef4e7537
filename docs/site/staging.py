"""The pages of the site, from the Markdown of the repository: copied, with links that lead to pages of the site.

What the documents link to is put beside them: other documents, pictures, and the text of source files, each as a page.
The headings and tables of docs/index.md are the table of contents.  Notebooks become Markdown, by stories.py.
"""

from __future__ import annotations

import functools
import os
import re
import shutil
from collections.abc import Callable, Iterable
from pathlib import Path

from cards import card_page
from stories import story_pictures, story_text

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / "docs"
PROJECT_PAGES = ("README", "ARCHITECTURE", "CONTRIBUTING", "CHANGELOG", "SECURITY", "SUPPORT")
DETAILS = ("benchmarks/tables.md", "verification/tables.md", "verification/error-rates.md")
GENERATED = {
    "Commands": ("commands/index.md", "Every command", "What are the arguments and options of each command?"),
    "Reference": ("reference/index.md", "Every public name", "What does this function take, return and refuse?"),
}
"""Pages that the documents do not have themselves, by the heading of docs/index.md under which they belong."""

LANGUAGES = {".py": "python", ".pyi": "python", ".rs": "rust", ".toml": "toml", ".json": "json", ".mjs": "javascript"}
LANGUAGES |= {".js": "javascript", ".ts": "typescript", ".cff": "yaml"}
LONGEST_SOURCE = 200_000  # bytes; a longer file is offered as it is

FENCE = re.compile(r"^(`{3,})[^\n]*\n.*?^\1[ ]*$", re.DOTALL | re.MULTILINE)
SPAN = re.compile(r"(?<!`)(`+)(?!`).+?(?<!`)\1(?!`)", re.DOTALL)
LINK = re.compile(r"(?P<before>\]\()(?P<target>[^)\s]+)(?P<after>\))")
WHOLE_LINK = re.compile(r"(?<!!)\[(?P<words>(?:[^\[\]]|\[[^\]]*\])*)\]\((?P<target>[^)\s]+)\)")
GROUP = re.compile(r"^## (.+)$", re.MULTILINE)
ROW = re.compile(r"^\| \[([^\]]+)\]\(([^)]+)\)", re.MULTILINE)
KEY = re.compile(r"^- \*\*\[(\w+)\]\*\*", re.MULTILINE)
CITED = re.compile(r"(?<![\[\w*])\[([a-z]+\d{4}[a-z]?)\](?![(\]:])")


class Stage:
    """A folder with the sources of the site."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.sources: set[Path] = set()
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)

    def fill(self) -> None:
        """Write all pages that come from documents."""
        for document, page in documents().items():
            text = self.with_links(document, page)
            if page == "index.md":
                text = with_contents(text, self.exists)
            if page == "gallery/index.md" and "{toctree}" not in text:
                text += hidden_toctree([("", f"{script.stem}.md") for script in scripts()], caption=None)
            if page == "references.md":
                text = KEY.sub(r"- []{#\1}**[\1]**", text)
            else:
                text = outside_code(text, lambda part, page=page: cited(part, page))
            self.write(page, text)
            if document.suffix == ".ipynb":
                for name, picture in story_pictures(document).items():
                    (self.folder / page).with_name(name).write_bytes(picture)
        for folder in (path for path in DOCS.iterdir() if path.is_dir() and path.name != "site"):
            shutil.copytree(folder, self.folder / folder.name, dirs_exist_ok=True, ignore=_not_a_picture)
        for path in sorted(self.sources):
            self.write(source_page(path), source_text(path))

    def write(self, page: str, text: str) -> None:
        """Write one page."""
        path = self.folder / page
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    def exists(self, page: str) -> bool:
        """Whether a page of the site is made, here or by a generator; the gallery may be missing."""
        return not page.startswith("gallery/") or page in documents().values()

    def with_links(self, document: Path, page: str) -> str:
        """The text of a document whose links lead to pages of the site; words that link to a folder stay words."""
        known = documents()

        def there(target: str) -> str | None:
            if re.match(r"\w+:|#", target):
                return target
            name, mark, heading = target.partition("#")
            path = (document.parent / name).resolve()
            if document.suffix == ".ipynb" and (path == document or name in story_pictures(document)):
                return name  # both lie beside the page
            if path in known:
                return relative(known[path], page) + mark + heading
            if path.is_dir():
                return None
            if path.suffix in {".png", ".svg", ".jpg", ".webp", ".html"} and DOCS in path.parents:
                return relative(path.relative_to(DOCS).as_posix(), page)
            self.sources.add(path)
            return relative(source_page(path), page)

        def link(match: re.Match[str]) -> str:
            target = there(match["target"])
            return match[0] if target is None else f"{match['before']}{target}{match['after']}"

        def words_of_folders(match: re.Match[str]) -> str:
            return match["words"] if there(match["target"]) is None else match[0]

        text = outside_code(text_of(document), lambda part: WHOLE_LINK.sub(words_of_folders, part))
        return outside_code(text, lambda part: LINK.sub(link, part))


def scripts() -> list[Path]:
    """The scripts of the gallery, each of which becomes a page."""
    return sorted(path for path in (DOCS / "gallery").glob("*.py") if path.name != "make.py")


def documents() -> dict[Path, str]:
    """Every document that becomes a page, and the page."""
    pages = {path: path.relative_to(DOCS).as_posix() for path in sorted(DOCS.rglob("*.md"))}
    stories = sorted((DOCS / "stories").glob("*.ipynb"))
    pages |= {path: path.relative_to(DOCS).with_suffix(".md").as_posix() for path in stories}
    pages |= {path: path.relative_to(DOCS).with_suffix(".md").as_posix() for path in scripts()}
    pages |= {path: f"{path.parent.name}-{path.name}" for path in map(ROOT.joinpath, DETAILS)}
    return pages | {ROOT / f"{name}.md": f"{name.lower()}.md" for name in PROJECT_PAGES}


def text_of(document: Path) -> str:
    """The Markdown of a document."""
    made = {".ipynb": story_text, ".py": card_page}.get(document.suffix)
    return made(document) if made else document.read_text(encoding="utf-8")


def relative(page: str, to: str) -> str:
    """The way from one page of the site to another."""
    return Path(os.path.relpath(page, Path(to).parent)).as_posix()


def outside_code(text: str, change: Callable[[str], str]) -> str:
    """A text that is changed where it is neither in a fenced block nor in a code span.

    A link whose words are a code span is changed, too: the span is put aside, and back afterwards.
    """
    aside: list[str] = []

    def away(match: re.Match[str]) -> str:
        aside.append(match[0])
        return f"\0{len(aside) - 1}\0"

    text = SPAN.sub(away, FENCE.sub(away, text))
    text = change(text)
    while "\0" in text:
        text = re.sub("\0(\\d+)\0", lambda match: aside[int(match[1])], text)
    return text


@functools.cache
def keys() -> frozenset[str]:
    """The keys of docs/references.md."""
    return frozenset(KEY.findall((DOCS / "references.md").read_text(encoding="utf-8")))


def cited(text: str, page: str) -> str:
    """A text whose keys of references lead to them."""

    def link(match: re.Match[str]) -> str:
        key = match[1]
        return rf"[\[{key}\]]({relative('references.md', page)}#{key})" if key in keys() else match[0]

    return CITED.sub(link, text)


def groups(index: str) -> dict[str, list[tuple[str, str]]]:
    """What docs/index.md lists, titles and pages, by the headings of its tables."""
    parts = GROUP.split(index)[1:]
    found = {title: ROW.findall(text) for title, text in zip(parts[::2], parts[1::2], strict=True)}
    return {title: pages for title, pages in found.items() if pages}


def with_contents(index: str, exists: Callable[[str], bool]) -> str:
    """The front page with the rows of generated pages and the table of contents that its own tables are."""
    for title, (page, words, question) in GENERATED.items():
        if exists(page):
            first = re.search(rf"^## {title}\n.*?^\|---\|---\|\n", index, re.DOTALL | re.MULTILINE)
            if first is None:
                raise ValueError(f"docs/index.md needs a table below the heading {title!r}")
            index = f"{index[: first.end()]}| [{words}]({page}) | {question} |\n{index[first.end() :]}"
    trees = (hidden_toctree(pages, caption=title) for title, pages in groups(index).items())
    return index + "".join(trees)


def hidden_toctree(pages: Iterable[tuple[str, str]], *, caption: str | None) -> str:
    """A part of the table of contents, titles and pages, for the sidebar alone."""
    options = ":hidden:\n" + (f":caption: {caption}\n" if caption else "")
    names = "\n".join(
        f"{title} <{page.removesuffix('.md')}>" if title else page.removesuffix(".md") for title, page in pages
    )
    return f"\n```{{toctree}}\n{options}\n{names}\n```\n"


def source_page(path: Path) -> str:
    """The page that shows a source file."""
    return f"source/{path.relative_to(ROOT).as_posix()}.md"


def source_text(path: Path) -> str:
    """A source file as a page; it is not searched, since its words are not prose."""
    name = path.relative_to(ROOT).as_posix()
    content = path.read_text(encoding="utf-8")
    if len(content) > LONGEST_SOURCE:
        content = content[:LONGEST_SOURCE] + "\n... and so on; the whole file is in the repository.\n"
    fence = "`" * (1 + max([2, *(len(run) for run in re.findall(r"`+", content))]))
    language = LANGUAGES.get(path.suffix, "text") if len(content) < LONGEST_SOURCE else "text"
    return f"---\norphan: true\nnosearch: true\n---\n\n# {name}\n\n{fence}{language}\n{content.rstrip()}\n{fence}\n"


def _not_a_picture(_: str, names: list[str]) -> set[str]:
    return {name for name in names if name.endswith((".md", ".py", ".json", ".pyc")) or name == "__pycache__"}
