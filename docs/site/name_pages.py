"""A page for each public name, from its signature, its annotations and its docstring."""

from __future__ import annotations

import ast
import functools
import inspect
import re
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import liepoisson as lp

if TYPE_CHECKING:
    from staging import Stage

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from public_names import chapters, is_error, is_result
from staging import cited, outside_code

GROUPS = {
    "Write a system": ("systems", "algebras", "extensions", "brackets", "catalog", "fields"),
    "Integrate": ("orbits", "methods"),
    "Exponents and chaos": ("chaos", "fits"),
    "Noise": ("stochastic",),
    "Sections": ("sections",),
    "Leaves, equilibria and charts": ("phase_space", "dissipation", "charts"),
    "Tori of integrable systems": ("tori",),
    "Prove": ("integrability", "proofs"),
    "Sweep": ("sweeps",),
    "Draw": ("plot",),
    "See it move, in a browser or a notebook": ("laboratory",),
    "Keep, load and repeat": ("results",),
    "Cite": ("citations",),
    "What is refused": ("errors",),
}
"""The chapters in the order in which a user meets them."""

SECTIONS = ("Args", "Attributes", "Returns", "Yields", "Raises", "Warns", "Example", "Examples", "References", "Note")
TITLES = {"Args": "Arguments", "Attributes": "Attributes", "Warns": "Warns", "Example": "Example"}
LISTS = ("Args", "Attributes", "Raises", "Warns")


class Name(NamedTuple):
    """A public name: the chapter and what the chapter calls it."""

    chapter: str
    name: str

    @property
    def value(self) -> Any:
        """What it is."""
        return getattr(chapters()[self.chapter], self.name)

    @property
    def long(self) -> str:
        """As users write it, by its chapter."""
        return f"lp.{self.chapter}.{self.name}"

    @property
    def short(self) -> str:
        """As users write it: by the name at the top if there is one."""
        at_the_top = self.name in lp.__all__ and getattr(lp, self.name) is self.value
        return f"lp.{self.name}" if at_the_top else self.long

    @property
    def page(self) -> str:
        """Its page, without suffix; the names of errors share one."""
        return f"reference/{self.chapter}" if self.chapter == "errors" else f"reference/{self.chapter}.{self.name}"


@functools.cache
def names() -> tuple[Name, ...]:
    """All public names, chapter by chapter."""
    return tuple(Name(chapter, name) for chapter, module in chapters().items() for name in module.__all__)


@functools.cache
def spoken() -> dict[str, Name]:
    """The public name that an identifier means wherever it stands: dotted ones, and others that cannot be a word."""
    found = {dotted: one for one in names() for dotted in (one.long, one.short)}
    for one in names():
        if (one.name[0].isupper() or "_" in one.name) and sum(other.name == one.name for other in names()) == 1:
            found[one.name] = one
    return found


def write(stage: Stage) -> None:
    """Write reference/index.md, a page for each chapter, for each name, and for the other types in signatures."""
    placed = [chapter for group in GROUPS.values() for chapter in group]
    if sorted(placed) != sorted(chapters()):
        raise ValueError(f"GROUPS of {__file__} must have every chapter once: {set(placed) ^ set(chapters())}")
    for one in names():
        if one.chapter != "errors":
            stage.write(f"{one.page}.md", name_page(one))
    for chapter in chapters():
        stage.write(f"reference/{chapter}.md", chapter_page(chapter))
    stage.write("reference/types.md", types_page())
    stage.write("reference/index.md", index_page())


def index_page() -> str:
    """The chapters by what a user wants to do."""
    lines = [
        "# Every public name",
        "",
        "`import liepoisson as lp`. Names are in chapters, as `lp.orbits.integrate`; the most used",
    ]
    lines += ["are at the top, too, as `lp.integrate`. Each has one entry here.", ""]
    tree = []
    for group, members in GROUPS.items():
        lines += [f"## {group}", "", "| chapter | names |", "|---|---|"]
        for chapter in members:
            links = ", ".join(
                f"`{one.name}`" if chapter == "errors" else f"[`{one.name}`]({Path(one.page).name}.md)"
                for one in names()
                if one.chapter == chapter
            )
            lines.append(f"| [`lp.{chapter}`]({chapter}.md) | {first_sentence(chapters()[chapter])} {links} |")
            tree.append(f"lp.{chapter} <{chapter}>")
        lines.append("")
    lines += ["Arguments and results have types that need no import: [types in signatures](types.md).", ""]
    tree.append("Types in signatures <types>")
    return "\n".join([*lines, "```{toctree}", ":hidden:", "", *tree, "```", ""])


def chapter_page(chapter: str) -> str:
    """What a chapter is for, and its names."""
    module = chapters()[chapter]
    summary, *rest = inspect.cleandoc(module.__doc__ or "").split("\n\n")
    lines = [f"# lp.{chapter}", "", summary, "", *(f"{part}\n" for part in rest)]
    members = [one for one in names() if one.chapter == chapter]
    if chapter == "errors":
        for one in members:
            lines += [*entry(one, ":::"), ""]
        return "\n".join(lines)
    lines += ["| name | what it is |", "|---|---|"]
    lines += [f"| [`{one.name}`]({Path(one.page).name}.md) | {first_sentence(one.value)} |" for one in members]
    tree = [f"{one.name} <{Path(one.page).name}>" for one in members]
    return "\n".join([*lines, "", "```{toctree}", ":hidden:", "", *tree, "```", ""])


def name_page(one: Name) -> str:
    """The page of one name."""
    also = f"; its name there is `{one.long}`" if one.short != one.long else ""
    return "\n".join(
        [
            f"# {one.short}",
            "",
            f"In the chapter [`lp.{one.chapter}`]({one.chapter}.md){also}.",
            "",
            *entry(one, "::::"),
            "",
        ]
    )


def entry(one: Name, fence: str) -> Iterator[str]:
    """The entry of a name: signature, docstring and, of a class, what its objects can be asked."""
    value = one.value
    kind = "exception" if is_error(value) else "class" if isinstance(value, type) else "function"
    signature = "" if is_error(value) or is_result(one.chapter, value) else signature_of(value)
    yield f"{fence}{{py:{kind}}} {one.short}{signature}"
    if one.short != one.long:
        yield f":canonical: {one.long}"
    yield ""
    if is_error(value):
        parents = [base.__name__ for base in value.__mro__[1:] if base.__name__ in spoken() or base is KeyError]
        yield from (f"A kind of `{parents[0]}`.", "") if parents else ()
    yield from body(value)
    if isinstance(value, type) and not is_error(value):
        for member, found in members_of(value):
            yield from member_entry(value, member, found, fence[1:])
        yield from inherited(value)
    yield fence


def members_of(value: type) -> Iterator[tuple[str, Any]]:
    """What a class has itself or from bases that are not public: methods and properties, each once."""
    seen: set[str] = set()
    for base in value.__mro__:
        if not base.__module__.startswith("liepoisson") or (base is not value and base.__name__ in spoken()):
            continue
        for member, found in vars(base).items():
            plain = found.__func__ if isinstance(found, classmethod | staticmethod) else found
            kinds = property | functools.cached_property
            if (
                not member.startswith("_")
                and member not in seen
                and (isinstance(found, kinds) or inspect.isroutine(plain))
            ):
                seen.add(member)
                yield member, found


def inherited(value: type) -> Iterator[str]:
    """A sentence on what a class has from a public base."""
    for base in value.__mro__[1:]:
        if base.__name__ in spoken() and base.__module__.startswith("liepoisson"):
            own = {member for member, _ in members_of(value)}
            rest = [f"`{member}`" for member, _ in members_of(base) if member not in own]
            if rest:
                yield from ("", f"It also has what every `{base.__name__}` has: {', '.join(rest)}.", "")


def member_entry(owner: type, member: str, found: Any, fence: str) -> Iterator[str]:
    """The entry of a method or a property."""
    if isinstance(found, property | functools.cached_property):
        getter: Any = found.fget if isinstance(found, property) else found.func
        result = inspect.signature(getter).return_annotation
        yield f"{fence}{{py:property}} {member}"
        if result is not inspect.Signature.empty:
            yield f":type: {annotation(str(result), getter.__module__)}"
    else:
        function = found.__func__ if isinstance(found, classmethod | staticmethod) else found
        kind = (
            "classmethod"
            if isinstance(found, classmethod)
            else "staticmethod"
            if isinstance(found, staticmethod)
            else None
        )
        yield f"{fence}{{py:method}} {member}{signature_of(function, bound=kind != 'staticmethod')}"
        if kind is not None:
            yield f":{kind}:"
        getter = function
    yield from ("", *body(getter, owner=owner, member=member), fence, "")


def body(value: Any, *, owner: type | None = None, member: str = "") -> Iterator[str]:
    """A docstring as Markdown."""
    text = inspect.getdoc(value) if owner is None else documentation(owner, member, value)
    sections = list(split(inspect.cleandoc(text or "")))
    for title, text in sections:
        content = outside_code(text, lambda part: cited(part, "reference/index.md"))
        if title is None:
            yield from (fenced_examples(content), "")
        elif title in LISTS:
            yield f"**{TITLES.get(title, title)}**"
            yield ""
            yield from definitions(title, content, value)
        elif title in ("Example", "Examples"):
            yield from (f"**{title}**", "", fenced_examples(content), "")
        else:
            yield from (f"**{title}**", "", content, "")


def documentation(owner: type, member: str, value: Any) -> str | None:
    """The docstring of a member, or that of the method which it replaces."""
    for base in owner.__mro__:
        found = vars(base).get(member)
        text = getattr(found, "__doc__", None)
        if text:
            return text
    return getattr(value, "__doc__", None)


def split(text: str) -> Iterator[tuple[str | None, str]]:
    """The parts of a docstring: its prose, and its sections by name."""
    title: str | None = None
    lines: list[str] = []
    for line in text.splitlines():
        heading = re.match(rf"({'|'.join(SECTIONS)}):(?:\s+(.*))?$", line)
        if heading:
            if any(lines):
                yield title, inspect.cleandoc("\n" + "\n".join(lines))
            title, lines = heading[1], [heading[2]] if heading[2] else []
        elif title is not None and line and not line.startswith(" ") and heading is None and lines and not lines[-1]:
            yield title, inspect.cleandoc("\n" + "\n".join(lines))
            title, lines = None, [line]
        else:
            lines.append(line)
    if any(lines):
        yield title, inspect.cleandoc("\n" + "\n".join(lines))


def definitions(title: str, content: str, value: Any) -> Iterator[str]:
    """The entries `name: text` of a section as a definition list, attributes with their types."""
    items: list[list[str]] = []
    for line in content.splitlines():
        match = re.match(r"([\w, *.]+?):(?:\s+(.*))?$", line)
        if match and not line.startswith(" "):
            items.append([match[1], match[2] or ""])
        elif items:
            items[-1].append(line.strip())
        else:
            items.append(["", line])
    types = annotations_of(value) if title == "Attributes" else {}
    for name, *lines in items:
        words = ", ".join(f"`{word.strip()}`" for word in name.split(","))
        kind = f" : `{types[name]}`" if name in types else ""
        yield f"{words}{kind}"
        yield ": " + "\n  ".join(lines).strip()
        yield ""


def annotations_of(value: Any) -> dict[str, str]:
    """The annotations of the fields of a class, as they are written."""
    found: dict[str, str] = {}
    for base in reversed(getattr(value, "__mro__", ())):
        found |= {name: str(kind) for name, kind in inspect.get_annotations(base).items()}
    return found


def fenced_examples(text: str) -> str:
    """Prose whose sessions of the interpreter stand in fences."""
    parts: list[str] = []
    for part in re.split(r"\n\s*\n", text):
        parts.append(f"```pycon\n{part}\n```" if part.lstrip().startswith(">>>") else part)
    return "\n\n".join(parts)


def signature_of(value: Any, *, bound: bool = False) -> str:
    """The signature, with annotations whose names lead to entries."""
    try:
        signature = inspect.signature(value)
    except (TypeError, ValueError):
        return ""
    parameters = list(signature.parameters.values())[1 if bound else 0 :]
    written, starred = [], False
    for one in parameters:
        if one.kind is one.KEYWORD_ONLY and not starred:
            written.append("*")
        starred = starred or one.kind in (one.KEYWORD_ONLY, one.VAR_POSITIONAL)
        text = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "") + one.name
        if one.annotation is not one.empty:
            text += f": {annotation(str(one.annotation), value.__module__)}"
        if one.default is not one.empty:
            text += f" = {default(one.default)}" if one.annotation is not one.empty else f"={default(one.default)}"
        written.append(text)
    result = signature.return_annotation
    shown = isinstance(value, type) or result is signature.empty
    arrow = "" if shown else f" -> {annotation(str(result), value.__module__)}"
    return f"({', '.join(written)}){arrow}"


def default(value: Any) -> str:
    """A default value as it would be typed."""
    text = repr(value)
    if isinstance(value, float) and text in ("inf", "-inf", "nan"):
        return text
    try:
        ast.parse(text, mode="eval")
    except SyntaxError:
        return "..."
    return text


def annotation(text: str, module: str) -> str:
    """An annotation with the full names of what has an entry."""
    text = re.sub(r"^'(.*)'$", r"\1", re.sub(r"<class '([\w.]+)'>", r"\1", text))

    def full(match: re.Match[str]) -> str:
        word = match[0]
        if match.start() and text[match.start() - 1] in "'\"":  # a value of Literal
            return word
        if word.split(".")[-1] in spoken() and word[0].isupper():
            return spoken()[word].short
        private = defined(word, module)
        return word if private is None else private

    return re.sub(r"(?<![\w.])[A-Za-z_][\w.]*", full, text)


USED: set[tuple[str, str]] = set()
"""Types of signatures that are no public names, by module and name: filled while pages are written."""


def defined(word: str, module: str) -> str | None:
    """Where liepoisson defines a type that is no public name, noted as used."""
    found = owner_of(word, module)
    if found is None or word == "Self":
        return None
    USED.add((found, word))
    return f"{found}.{word}"


@functools.cache
def owner_of(word: str, module: str) -> str | None:
    """The module that defines what a module calls so, if it is one of the package and compiled by none."""
    tree = tree_of(module)
    if tree is None:
        return None
    for node in ast.walk(tree):
        match node:
            case ast.ImportFrom(module=str(origin), names=aliases, level=0) if origin.startswith("liepoisson"):
                if any((alias.asname or alias.name) == word for alias in aliases):
                    return owner_of(word, origin)
            case ast.ClassDef(name=name) if name == word:
                return module
            case ast.AnnAssign(target=ast.Name(id=name)) if name == word and "TypeAlias" in ast.unparse(
                node.annotation
            ):
                return module
            case _:
                pass
    return None


@functools.cache
def tree_of(module: str) -> ast.Module | None:
    """The source of a module as a tree."""
    file = getattr(import_module(module), "__file__", None) or ""
    return ast.parse(Path(file).read_text(encoding="utf-8")) if file.endswith(".py") else None


def types_page() -> str:
    """Entries of the types of signatures that are no public names; writing them may name further ones."""
    lines = [
        "# Types in signatures",
        "",
        "Nobody needs to import these: they say what may be given, and what comes back.",
        "",
    ]
    written: set[tuple[str, str]] = set()
    entries: dict[str, list[str]] = {}
    while USED - written:
        for module, word in sorted(USED - written):
            written.add((module, word))
            entries[f"{word} {module}"] = type_entry(module, word)
    return "\n".join([*lines, *(line for key in sorted(entries, key=str.lower) for line in entries[key]), ""])


def type_entry(module: str, word: str) -> list[str]:
    """The entry of one of them."""
    value = getattr(import_module(module), word)
    if isinstance(value, type):
        lines = [f"::::{{py:class}} {module}.{word}", "", *body(value)]
        for member, found in members_of(value):
            lines += member_entry(value, member, found, ":::")
        return [*lines, "::::", ""]
    tree = tree_of(module)
    nodes = tree.body if tree else []
    text, explained = "", ""
    for node, after in zip(nodes, [*nodes[1:], None], strict=True):
        match node:
            case ast.AnnAssign(target=ast.Name(id=name), value=ast.expr() as given) if name == word:
                text = given.value if isinstance(given, ast.Constant) else ast.unparse(given)
                match after:
                    case ast.Expr(value=ast.Constant(value=str(said))):
                        explained = inspect.cleandoc(said)
                    case _:
                        pass
            case _:
                pass
    return [
        f":::{{py:data}} {module}.{word}",
        "",
        *([explained, ""] if explained else []),
        f"One of `{text}`.",
        ":::",
        "",
    ]


def first_sentence(value: Any) -> str:
    """The first paragraph of a docstring, in a cell of a table."""
    return inspect.cleandoc(value.__doc__ or "").split("\n\n")[0].replace("\n", " ").replace("|", r"\|")
