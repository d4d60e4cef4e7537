"""How to cite the package and the works that describe what was used, as text and as BibTeX.

The data are in `citation.toml`, of which CITATION.cff is made; the sources of systems are those of the catalog.
"""

from __future__ import annotations

import re
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, cast

from liepoisson.errors import ParameterError
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.refusals import shown
from liepoisson.io.display import as_text

DATA = Path(__file__).with_suffix(".toml")

PAPER = "twistedtop2001"
"""The work that every twisted top is from."""

_AUTHOR = re.compile(r"(?:[^\W\d_]\.-?\s?)+([^\W\d_][\w’'-]+)")
"""Initials and a name, with which a source begins."""

_SPECIAL = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}


@explains_its_methods
@dataclass(frozen=True)
class Work:
    """One entry of a list of references.

    Example:
        >>> lp.cite("toda").works[2].text
        'M. Hénon, Integrals of the Toda lattice, Physical Review B 9 (1974) 1921.'

    Attributes:
        key: Its key in BibTeX.
        text: The entry as a sentence.
        bibtex: The entry as BibTeX. A source that the catalog has as a sentence is `@misc` with that sentence as its
            `note`.
    """

    key: str
    text: str
    bibtex: str


@explains_its_methods
@dataclass(frozen=True, repr=False)
class Citation:
    """What to cite: the package first, then the works that describe what was used, each once.

    Example:
        >>> [work.key for work in lp.cite("kovalevskaya").works]
        ['liepoisson', 'kowalevski1889']

    Attributes:
        works: The entries.
    """

    works: tuple[Work, ...]

    @property
    def text(self) -> str:
        """The entries as sentences, one a line."""
        return "\n".join(work.text for work in self.works)

    @property
    def bibtex(self) -> str:
        """The entries as BibTeX."""
        return "\n\n".join(work.bibtex for work in self.works)

    def __repr__(self) -> str:
        """The text: what a session shows can be copied."""
        return self.text

    def _repr_html_(self) -> str:
        return as_text(self.text)


@explains_its_arguments
def cite(*used: Any) -> Citation:
    """Citation of liepoisson, and of the works that describe what was used.

    Example:
        >>> top = lp.Top.twisted_kovalevskaya()
        >>> lp.cite(top)
        The liepoisson developers, liepoisson: a laboratory for Lie-Poisson dynamics, version 0.1.0.
        J.-L. Thiffeault and P. J. Morrison, The twisted top, Physics Letters A 283 (2001) 335, arXiv:nlin/0101042.
        >>> [work.key for work in lp.cite(top, "toda").works]
        ['liepoisson', 'twistedtop2001', 'toda1967', 'henon1974', 'flaschka1974']
        >>> print(lp.cite().bibtex)
        @software{liepoisson,
          title = {liepoisson: a laboratory for Lie-Poisson dynamics},
          author = {{The liepoisson developers}},
          version = {0.1.0},
        }

    Args:
        used: Systems, system files, names of the catalog, and results, which stand for their systems. A system
            without a source adds nothing; a top with a cocycle is from the paper on the twisted top, [twistedtop2001].

    Raises:
        UnknownNameError: a text is no name of the catalog.
        ParameterError: something has no system, or is a sweep over systems that a function makes.
    """
    works = [_package()]
    for one in used:
        works += _works_of(one)
    return Citation(tuple(_with_own_keys(works)))


def _works_of(used: Any) -> list[Work]:
    """The works that describe one thing."""
    described = _described(used)
    source = described.get("source") if isinstance(described, Mapping) else described.source
    twisted = [work for work, _ in _known() if work.key == PAPER and _is_twisted(described)]
    return [*twisted, *map(_work, _parts(source or ""))]


def _parts(source: str) -> list[str]:
    """The works that a source names, one after the other; a part that names no author is a remark on the one before."""
    found: list[str] = []
    for part in filter(None, map(str.strip, source.split(";"))):
        if found and _AUTHOR.match(part) is None:
            found[-1] += f"; {part}"
        else:
            found.append(part)
    return found


def _described(used: Any) -> Any:
    """The thing itself or its system: what says where it is described."""
    spec = getattr(used, "spec", None)  # of a sweep, whose system may be a name, a file or its tables
    one = used if spec is None else spec.system
    if isinstance(one, str) or (spec is not None and isinstance(one, Path)):
        from liepoisson.catalog import entry
        from liepoisson.formula.toml_text import read_toml

        return read_toml(one).tables if spec is not None and str(one).endswith(".toml") else entry(str(one))
    if spec is not None and isinstance(one, Mapping):
        return cast("Any", one)
    for found in (one, getattr(one, "system", None)):
        if not isinstance(found, type) and isinstance(getattr(found, "source", 0), str | None):
            return found
    raise ParameterError(
        f"used: wanted a system, a system file, a name of the catalog or a result with a system; got {shown(used)}; "
        + ("give one of its systems" if spec is not None else "leave it out for the citation of liepoisson alone")
    )


def _is_twisted(system: Any) -> bool:
    """Whether it is a top with a cocycle."""
    from liepoisson.algebra.exact_numbers import is_zero

    top = getattr(system, "top_parameters", None)
    return top is not None and not is_zero(top.epsilon)


@cache
def data() -> dict[str, Any]:
    """What `citation.toml` says."""
    import tomllib

    return tomllib.loads(DATA.read_text(encoding="utf-8"))


def _package() -> Work:
    from liepoisson._core import __version__

    package = data()["package"]
    group = package["group"][0].upper() + package["group"][1:]
    fields = {"title": package["title"], "author": f"{{{group}}}", "version": __version__}
    return Work("liepoisson", f"{group}, {package['title']}, version {__version__}.", _entry("software", fields))


@cache
def _known() -> tuple[tuple[Work, str], ...]:
    """The works of the file, each with the words by which a source is known to be this work."""
    return tuple((_article(work), work["known_by"]) for work in data()["work"])


def _article(work: dict[str, Any]) -> Work:
    authors = " and ".join(f"{_initials(given)} {family}" for given, family in work["authors"])
    text = f"{authors}, {work['title']}, {work['journal']} {work['volume']} ({work['year']}) {work['start']}"
    fields = {
        "title": work["title"],
        "author": " and ".join(f"{family}, {given}" for given, family in work["authors"]),
        "journal": work["journal"],
        "volume": work["volume"],
        "pages": work["start"],
        "year": work["year"],
        "eprint": work["arxiv"],
        "archiveprefix": "arXiv",
    }
    return Work(work["key"], f"{text}, arXiv:{work['arxiv']}.", _entry("article", fields, work["key"]))


def _initials(given: str) -> str:
    """Given names as initials: "J.-L." of "Jean-Luc"."""
    return " ".join("-".join(f"{part[0]}." for part in name.split("-")) for name in given.split())


def _work(source: str) -> Work:
    """One work of a source: one of the file if its words are in it, otherwise the sentence as it is."""
    for work, words in _known():
        if words in source:
            return work
    year = next(iter(re.findall(r"\((\d{4})\)|\b(\d{4})\)", source)), ("", ""))
    fields = {"note": _escaped(source), "year": "".join(year)}
    key = _key(source, "".join(year))
    return Work(key, source.rstrip(".") + ".", _entry("misc", {k: v for k, v in fields.items() if v}, key))


def _key(source: str, year: str) -> str:
    """The first author's name and the year, in ASCII: "henon1974"."""
    author = _AUTHOR.match(source)
    word = author[1] if author else "source"
    plain = unicodedata.normalize("NFKD", word).encode("ascii", "ignore").decode()
    return re.sub(r"\W", "", plain).lower() + year or "source"


def _with_own_keys(works: list[Work]) -> list[Work]:
    """Each work once, and no two with one key."""
    found: dict[str, Work] = {}
    for work in dict.fromkeys(works):
        keys = (work.key + suffix for suffix in ("", *"bcdefghijklmnopqrstuvwxyz"))
        key = next((one for one in keys if one not in found), f"{work.key}-{len(found)}")
        found[key] = Work(key, work.text, work.bibtex.replace(f"{{{work.key},", f"{{{key},", 1))
    return list(found.values())


def _escaped(text: str) -> str:
    """A text that TeX prints as it stands."""
    return re.sub(r"[\\~^&%$#_{}]", lambda found: _SPECIAL.get(found[0], "\\" + found[0]), text)


def _entry(kind: str, fields: dict[str, Any], key: str = "liepoisson") -> str:
    lines = [f"  {name} = {{{value}}}," for name, value in fields.items()]
    return "\n".join([f"@{kind}{{{key},", *lines, "}"])
