"""The documents tell the truth: their Python and commands run and print what they show; what they name exists."""

import contextlib
import dataclasses
import inspect
import io
import re
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import pytest

import liepoisson as lp

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
GUIDE = [README, *sorted((ROOT / "docs").glob("*.md"))]
PROJECT_PAGES = ("ARCHITECTURE", "CHANGELOG", "CONTRIBUTING", "SECURITY", "SUPPORT")
DOCUMENTS = [*GUIDE, *(ROOT / f"{name}.md" for name in PROJECT_PAGES)]

FENCE = re.compile(r"^```(\w*)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
NUMBER = re.compile(r"(?<![\w.])[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")
SPAN = re.compile(r"`([^`\n]+)`")
FILE = re.compile(r"# (\w[\w-]*\.toml)\n")
COMMANDS = re.compile(r"(?:liepoisson (?!reproduce\b).*\n)+")


class Block(NamedTuple):
    """A fenced block of a document, and the line where its content begins."""

    language: str
    content: str
    line: int
    follows_directly: bool


def blocks(document: Path) -> Iterator[Block]:
    text, end = document.read_text(encoding="utf-8"), 0
    for match in FENCE.finditer(text):
        yield Block(match[1], match[2], text.count("\n", 0, match.start(2)), not text[end : match.start()].strip())
        end = match.end()


def prose(document: Path) -> str:
    return FENCE.sub("", document.read_text(encoding="utf-8"))


def named(documents: list[Path]) -> list[object]:
    return [pytest.param(document, id=str(document.relative_to(ROOT))) for document in documents]


def difference(shown: str, printed: str) -> str | None:
    """What is wrong with a shown output, or None.

    Words and whole numbers must be the same; a run of blanks stands for any other, `...` for anything.  A decimal of
    more than two digits may differ by one unit in the last: a page may make times or starts of its own with NumPy.
    Of two digits, a unit may be a tenth.
    """
    numbers = [piece for piece in _pieces(shown) if NUMBER.fullmatch(piece)]
    match = re.fullmatch("".join(map(_pattern, _pieces(shown))), printed.strip(), re.DOTALL)
    if match is None:
        return "the words or the layout differ"
    for wanted, got in zip(numbers, match.groups(), strict=True):
        place = last_place(wanted)
        allowed = 1.001 * place if abs(float(wanted)) > 99.5 * place else 0.0
        if abs(float(wanted) - float(got)) > allowed:
            return f"{wanted} is shown, {got} printed"
    return None


def with_numbers_of(shown: str, printed: str) -> str:
    """A shown output with the numbers that are printed now; as it is where words or layout differ."""
    pieces = _pieces(shown)
    match = re.fullmatch("".join(map(_pattern, pieces)), printed.strip(), re.DOTALL)
    if match is None:
        return shown
    now = iter(match.groups())
    return "".join(next(now) if NUMBER.fullmatch(piece) else piece for piece in pieces) + "\n"


def _pieces(shown: str) -> list[str]:
    return re.split(r"(\.\.\.|\s+|" + NUMBER.pattern + ")", shown.strip())


def _pattern(piece: str) -> str:
    if NUMBER.fullmatch(piece):
        return rf"({NUMBER.pattern})"
    return ".*" if piece == "..." else r"\s+" if piece.isspace() else re.escape(piece)


def last_place(number: str) -> float:
    """The unit of the last digit of a decimal; 0 for a whole number, which is a count."""
    mantissa, _, power = number.partition("e")
    decimals = len(mantissa.partition(".")[2])
    return 10.0 ** (int(power or 0) - decimals) if decimals or power else 0.0


@pytest.mark.parametrize("document", named(DOCUMENTS))
def test_every_fence_names_its_language_and_is_closed(document):
    """A fence that opens without a word would swallow the block after it, which then never runs."""
    inside = False
    for number, line in enumerate(document.read_text(encoding="utf-8").splitlines(), 1):
        if line.startswith("```"):
            assert inside is (line == "```"), f"{document.name}:{number}: {line}"
            inside = not inside
    assert not inside, document.name


@pytest.mark.thorough
@pytest.mark.parametrize("document", named(GUIDE))
def test_blocks_run_and_print_what_is_shown(document, tmp_path, monkeypatch):
    """In one folder and one namespace: Python, commands, and files (TOML that begins with a comment `# name.toml`)."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.delenv("LIEPOISSON_SIMD", raising=False)
    plt.close("all")  # pages leave theirs open, and Matplotlib warns of more than 20
    if "lp.view(" in "".join(block.content for block in blocks(document) if block.language == "python"):
        pytest.importorskip("anywidget")
    for block, printed in outputs(document):
        wrong = difference(block.content, printed)
        again = "" if wrong is None else "python docs/print_again.py writes what is printed now into the page\n"
        assert wrong is None, (
            f"{document.name}:{block.line}: {wrong}\n{again}shown:\n{block.content}\nprinted:\n{printed}"
        )


def outputs(document: Path) -> Iterator[tuple[Block, str]]:
    """Every block of shown output, and what is printed now; all blocks run in the current folder."""
    namespace: dict[str, object] = {"__name__": "__document__"}
    printed = None
    for block in blocks(document):
        if block.language == "text" and block.follows_directly and printed is not None:
            yield block, printed
        printed = None
        if block.language == "python":
            code = compile("\n" * block.line + block.content, str(document), "exec")
            with contextlib.redirect_stdout(io.StringIO()) as output:
                exec(code, namespace)
            printed = output.getvalue()
        elif block.language == "sh" and COMMANDS.fullmatch(block.content):
            printed = "".join(map(typed, block.content.splitlines()))
        elif block.language == "toml" and (name := FILE.match(block.content)):
            Path(name[1]).write_text(block.content, encoding="utf-8")


def typed(line: str) -> str:
    """What a command prints on a terminal that shows Unicode; the text of a refusal, too."""
    from liepoisson.cli.main import main

    with pytest.MonkeyPatch.context() as patch, io.TextIOWrapper(io.BytesIO(), encoding="utf-8") as terminal:
        for stream in ("stdout", "stderr"):
            patch.setattr(sys, stream, terminal)
        patch.setattr(sys, "argv", shlex.split(line))
        with pytest.raises(SystemExit) as stopped:
            main()
        terminal.seek(0)
        printed = terminal.read()
    assert not stopped.value.code or printed.startswith("liepoisson: "), f"{line!r} ended with {stopped.value.code}"
    return printed


@pytest.mark.parametrize("document", named(DOCUMENTS))
def test_relative_links_resolve(document):
    for target in LINK.findall(SPAN.sub("", prose(document))):
        if re.match(r"\w+:", target):
            continue
        path, _, heading = target.partition("#")
        file = (document.parent / path).resolve() if path else document
        assert file.exists(), f"{document.name} links to {target}, which does not exist"
        if heading:
            assert heading in headings(file), f"{document.name} links to {target}; {file.name} has no such heading"


def headings(document: Path) -> set[str]:
    """The anchors that GitHub gives to the headings of a document."""
    titles = re.findall(r"^#+ (.+)$", prose(document), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


@pytest.mark.parametrize("document", named(DOCUMENTS))
def test_public_names_exist(document):
    for dotted in re.findall(r"\blp((?:\.\w+)+)", " ".join(SPAN.findall(prose(document)))):
        here: object = lp
        for name in dotted.strip(".").split("."):
            here = attribute(here, name, f"{document.name}: lp{dotted} does not exist")


def attribute(owner: object, name: str, message: str) -> object:
    """A member of a module or class; a field or an argument counts, which the class object itself does not hold."""
    if hasattr(owner, name):
        return getattr(owner, name)
    fields = {field.name for field in dataclasses.fields(owner)} if dataclasses.is_dataclass(owner) else set()
    arguments = set(inspect.signature(owner).parameters) if inspect.isclass(owner) else set()
    assert name in fields | arguments, message
    return None


@pytest.mark.parametrize("document", named(DOCUMENTS))
def test_names_of_the_core_exist(document):
    sources = "\n".join(path.read_text(encoding="utf-8") for path in (ROOT / "crates").rglob("*.rs"))
    for span in SPAN.findall(prose(document)):
        for path in re.findall(r"\w+(?:::\w+)+", span):
            for name in path.split("::"):
                assert re.search(rf"\b{name}\b", sources), f"{document.name}: no {name} of `{span}` in crates/"


@pytest.mark.parametrize("document", named(DOCUMENTS))
def test_recipes_exist(document):
    recipes = set(re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    shell = [block.content for block in blocks(document) if block.language == "sh"]
    for recipe in re.findall(r"\bmake ([a-z][a-z-]*)", "\n".join([*shell, *SPAN.findall(prose(document))])):
        assert recipe in recipes, f"{document.name}: the Makefile has no recipe {recipe!r}"


@pytest.mark.parametrize("document", named(DOCUMENTS))
def test_options_of_the_command_line_exist(document):
    from typer.main import get_command

    from liepoisson.cli.main import application

    command = get_command(application())
    known = {name: {"--help", *(o for p in part.params for o in p.opts)} for name, part in command.commands.items()}
    known[""] = {"--help", *(option for parameter in command.params for option in parameter.opts)}
    shell = "\n".join(block.content for block in blocks(document) if block.language == "sh")
    for line in [*shell.splitlines(), *SPAN.findall(prose(document))]:
        if words := re.fullmatch(r"\S*liepoisson(?: (?!-)(\S+))?((?: .*)?)", line):
            assert (words[1] or "") in known, f"{document.name}: {line!r} names no command"
            options = set(re.findall(r"(?<= )--[a-z-]+", words[2]))
            assert options <= known[words[1] or ""], f"{document.name}: {line!r} has options that are not known"


@pytest.mark.parametrize("name", lp.catalog.names())
def test_catalog_page_has_the_entry(name):
    page = (ROOT / "docs" / "catalog.md").read_text(encoding="utf-8")
    assert row_of_catalog(name) in page.splitlines(), f"docs/catalog.md needs this row:\n{row_of_catalog(name)}"


def test_catalog_page_lists_nothing_else():
    page = (ROOT / "docs" / "catalog.md").read_text(encoding="utf-8")
    assert re.findall(r"^\| \[`([\w-]+)`\]", page, re.MULTILINE) == list(lp.catalog.names())


def row_of_catalog(name: str) -> str:
    entry = lp.catalog.entry(name)
    integrals = ", ".join(f"`{key}`" for key in entry.integrals) or "none"
    cells = (f"[`{name}`](../python/liepoisson/catalog/{name}.toml)", in_short(entry.description or ""), integrals)
    return "| " + " | ".join(" ".join(str(cell).split()).replace("|", r"\|") for cell in cells) + " |"


def in_short(description: str) -> str:
    """What stands before details: up to a semicolon, or to a colon after six words or more."""
    first = description.partition(";")[0]
    before = first.partition(": ")[0]
    return before if len(before.split()) >= 6 else first


@pytest.mark.parametrize(
    ("shown", "printed", "agree"),
    [
        ("lambda = 0.126 ± 0.002", "lambda = 0.127 ± 0.002", True),
        ("lambda = 0.126 ± 0.002", "lambda = 0.122 ± 0.003", False),
        ("lambda = 0.126 ± 0.002", "lambda = 0.126 ± 0.004", False),
        ("lambda = 0.126", "lambda = 0.128", False),
        ("lambda = 0.126", "mu = 0.126", False),
        ("18 steps", "19 steps", False),
        ("first\n...\nlast", "first\nmore\nlast", True),
        ("l3/2 + alpha2", "l3/3 + alpha2", False),
        ("1.52e-10", "1.53e-10", True),
        ("1.5e-10", "1.6e-10", False),
        ("0.16", "0.15", False),
        ("1.5e-10", "1.5e-09", False),
    ],
)
def test_outputs_are_compared_as_stated(shown, printed, agree):
    assert (difference(shown, printed) is None) is agree


def test_a_page_gets_the_numbers_that_are_printed_now_and_keeps_its_words():
    assert (
        with_numbers_of("a = 0.12 ± 0.03\n...\nl3/2\n", "a = 0.13 ± 0.03\nmore\nl3/2\n")
        == "a = 0.13 ± 0.03\n...\nl3/2\n"
    )
    assert with_numbers_of("a = 1\n", "b = 2\n") == "a = 1\n"


@pytest.mark.parametrize("document", named(DOCUMENTS))
def test_a_link_that_shows_a_file_leads_to_it(document):
    shown = re.findall(
        r"\[`(?:[^`\]]*/)?([^`/\]]+\.(?:py|pyi|rs|ts))`\]\(([^)#]+)", document.read_text(encoding="utf-8")
    )
    wrong = [f"{name} -> {target}" for name, target in shown if Path(target).name != name]
    assert not wrong, f"{document.name} shows one file and leads to another: {', '.join(wrong)}"
