"""Pages of the laboratory: the built page with the system that it shows, as data that nothing can take for markup."""

from __future__ import annotations

import hashlib
import json
import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from fractions import Fraction
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np

from liepoisson.algebra.exact_numbers import is_sympy
from liepoisson.compile.field import TapeFunction
from liepoisson.errors import LiePoissonError, ParameterError, ShapeError
from liepoisson.formula.scalars import as_array
from liepoisson.inputs.calls import explains_its_arguments, explains_its_methods
from liepoisson.inputs.given import named, sequence
from liepoisson.io.files import write_atomically
from liepoisson.laboratory.description import description_of, picture_of, saved_of
from liepoisson.leaf.starts import read_state
from liepoisson.numeric.systems import as_field, component_names, has_bracket, reads_formulas
from liepoisson.poincare.section_arguments import check_that_it_varies, modulus_of_surface, tape_of_surface

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from liepoisson.inputs.arrays import Array
from liepoisson.inputs.refusals import shown

VERSION = 2
"""Of the description of a page, which the page looks at."""

MOST_COMPONENTS = 400
"""Of a system that the page shows; `systems/description.ts` has the same."""
MOST_TERMS = 100_000
"""Of its vector field."""
MOST_BYTES = 1_800_000
"""Of an exported page."""
LARGEST = 1e6
"""Of a number of a start, as the page takes it."""
_LONGEST_NAME = 200
_LONGEST_MODULUS = 12

_PLACE = "<noscript>"
"""Before this part of the built page stands what a page carries."""

_NUMBER = re.compile(r"-?\d+(\.\d+)?(e-?\d{1,3})?|-?\d+/\d+")
"""A parameter of a top as the page of tops reads it."""


@explains_its_methods
@dataclass(frozen=True)
class Page:
    """A page of the laboratory.

    Example:
        >>> page = lp.laboratory.page_of(lp.catalog.system("toda"))
        >>> page.words, len(page.record["components"])  # three positions and three momenta
        ('toda', 6)

    Attributes:
        html: The whole page: it needs no other file and asks for none.
        address: What is to follow the # of its address, or "".
        words: What it shows, for people.
        record: The description of the system that it carries; None for the page of tops.
    """

    html: str = field(repr=False)
    address: str
    words: str
    record: Mapping[str, Any] | None = field(default=None, repr=False, compare=False)


@explains_its_arguments
def page_of_tops() -> Page:
    """The page of tops, as it begins.

    Example:
        >>> page = lp.laboratory.page_of_tops()
        >>> page.words, len(page.html) < 1_800_000  # one file with script, style and core
        ('tops', True)
    """
    return Page(_built(), "", "tops")


@explains_its_arguments
def page_of(
    system: Any,
    *,
    start: ArrayLike | Mapping[str, Any] | None = None,
    surfaces: Sequence[Any] = (),
    result: Any = None,
    trajectory: int = 0,
) -> Page:
    """The page that shows a system.

    A top that the page of tops can be given is shown there, with its body; every other system has a page with its own
    components, surfaces and invariants.

    Example:
        >>> page = lp.laboratory.page_of(lp.catalog.system("kirchhoff"), start=[1, 0.2, 0, 0, 0.6, 0.8])
        >>> page.words, page.record["components"]
        ('kirchhoff', ['m1', 'm2', 'm3', 'p1', 'p2', 'p3'])

    Args:
        system: A `System`, a `Top`, anything that has a field.
        start: Where the orbit begins, shape (component,), or components by name, as `integrate` takes them; by default
            trajectory 0 of the random unit vectors.
        surfaces: Functions whose zeros can be chosen as surface of section, besides the components: formulas, as
            `lp.section` takes them.  The page begins with the first; by default with `lp.sections.default_surface`.
        result: A saved orbit or section of this system, which the page computes again and compares.  Its first start
            is then the start, and the surface of a section is one of the surfaces.
        trajectory: Which orbit of the result is drawn, and has the start.

    Raises:
        ParameterError: the system asks for too much, the start is too large, a formula cannot be read or is constant
            along every orbit, or the result is of another system or kind, or has no such trajectory.
        ShapeError: the start has another number of components.
    """
    chosen = _several(surfaces)
    if result is None and not (type(trajectory) is int and trajectory == 0):
        raise ParameterError(
            f"trajectory must be left out where there is no result, of which it is one; got {trajectory!r:.40}."
        )
    field = as_field(system)
    n = field.n_components
    _check_size(system, n, _terms(field))
    saved = None if result is None else saved_of(system, result, trajectory)
    if saved is not None and start is None:
        start = saved.start
    begin = _start(system, n, start)
    words = str(system.name)[:_LONGEST_NAME]
    if saved is None and not chosen:
        address = address_of_top(system, begin)
        if address is not None:
            return Page(_carrying(f'<script type="text/plain" id="address">{address}</script>'), address, words)
    record = _description(system, begin, chosen, saved)
    text = json.dumps(record, allow_nan=False, separators=(",", ":"))
    record = {"id": hashlib.sha256(text.encode()).hexdigest()[:12], **record}
    element = f'<script type="application/json" id="system">{as_data(record)}</script>'
    return Page(_carrying(element), "", words, record)


@explains_its_arguments
def write_page(page: Page, path: str | Path) -> Path:
    """Writes a page into one file, whole or not at all.

    Example:
        >>> from tempfile import mkdtemp
        >>> page = lp.laboratory.page_of(lp.Top.twisted_kovalevskaya())
        >>> lp.laboratory.write_page(page, f"{mkdtemp()}/top.html").name
        'top.html'

    Raises:
        ParameterError: the file would be larger than 1.8 MB.
        OutputError: it cannot be written.
    """
    content = page.html.encode()
    if len(content) > MOST_BYTES:
        raise ParameterError(
            f"a page must be at most {MOST_BYTES / 1e6:g} MB; that of {page.words!r:.80} has {len(content) / 1e6:.2f}. "
            "Leave out the saved result, or show it without --export."
        )
    write_atomically(Path(path), content)
    return Path(path)


def as_data(record: Mapping[str, Any] | str) -> str:
    """JSON without a character that ends an element, begins one, or breaks a line of a script."""
    text = json.dumps(record, allow_nan=False, separators=(",", ":"))
    for letter in "<>&\u2028\u2029":
        text = text.replace(letter, f"\\u{ord(letter):04x}")
    return text


def address_of_top(system: Any, start: Array) -> str | None:
    """What the page of tops has after the # for this top and this start; None for what it cannot be given.

    Its parameters have to be numbers that are written exactly: 1/3 and 0.25, but not sqrt(2).
    """
    top = getattr(system, "top_parameters", None)
    if top is None or start.shape != (9,):
        return None
    texts = [exact_text(value) for value in (*top.inertia, *top.a, *top.b, top.epsilon)]
    numbers = [text for text in texts if text is not None]
    if len(numbers) != len(texts) or any(float(value) < 0.01 for value in top.inertia):
        return None
    # where both centres are axial l3 is constant, or of one sign, more often than not
    section = "" if any([*top.a[:2], *top.b[:2]]) else "&section=l1,1&axes=l2,alpha1"
    return f"v=1&top={','.join(numbers)}&start={','.join(shortest(value) for value in start)}{section}"


def exact_text(value: Any) -> str | None:
    """A parameter of a top as the page reads it exactly, or None: a number of SymPy or a fraction."""
    text = str(value).replace(" ", "")
    if _NUMBER.fullmatch(text) is None or len(text) > 60 or abs(float(value)) > LARGEST:
        return None
    if all(int(part) < 2**53 for part in re.findall(r"\d+(?=/)|(?<=/)\d+", text)):
        return text
    decimal = shortest(float(value))  # such as 0.3333333333333333, a fraction of two numbers that are too large
    return decimal if Fraction(decimal) == Fraction(text) else None


def _description(system: Any, start: Array, surfaces: Sequence[Any], saved: Any) -> dict[str, Any]:
    known = description_of(system)
    n = start.size
    listed, surface = _surfaces(system, start, surfaces, saved)
    # time and its momentum come last
    clock = n if known["clock"] is None else known["clock"]
    others = sorted(range(n), key=lambda k: (k == surface, k in (clock, clock + 1), k))
    return {
        "version": VERSION,
        "name": known["name"][:_LONGEST_NAME],
        "words": str(getattr(system, "source", None) or "")[:400],
        "components": known["components"],
        "vector_length": known["vector_length"],
        "turns": known["turns"],
        "clock": known["clock"],
        "field": known["field"],
        "invariants": known["invariants"],
        "surfaces": listed,
        "start": [shortest(value) for value in start],
        "unit": unit_of(system, start),
        "surface": surface,
        "direction": 1 if saved is None else saved.record["direction"],
        "axes": sorted(others[:2]) if n > 1 else [0, 0],
        "picture": picture_of(system),
        "saved": None if saved is None else saved.record,
    }


def _surfaces(system: Any, start: Array, given: Sequence[Any], saved: Any) -> tuple[list[dict[str, Any]], int]:
    """All surfaces, first the components, and the number of the one that the page begins with."""
    names = component_names(system, start.size)
    components = [_component_surface(system, k, name) for k, name in enumerate(names)]
    if saved is not None and (functions := saved.record["functions"]) is not None:
        first = {**functions, "outputs": functions["outputs"][:1]}
        return [*components, _surface(saved.surface[:_LONGEST_NAME], first)], len(names)
    chosen = {str(one): one for one in given}
    for one in given if reads_formulas(system) else ():
        check_that_it_varies(system, one, "surfaces")
    if not chosen:
        name, formula = _default_surface(system, start)
        chosen = {name: formula}
    first = next(iter(chosen))
    listed = {name: formula for name, formula in chosen.items() if name not in names}
    if listed and not reads_formulas(system):
        raise ParameterError(
            f"surfaces: {system.name!r:.60} has a field alone and reads no formulas; got {next(iter(listed))!r:.60}. "
            "Leave them out: each component is a surface."
        )
    functions = [
        _surface(name, asdict(tape_of_surface(system, formula)), modulus_of_surface(system, formula))
        for name, formula in zip(_shortened(list(listed)), listed.values(), strict=True)
    ]
    return [*components, *functions], names.index(first) if first in names else len(names)


def _component_surface(system: Any, k: int, name: str) -> dict[str, Any]:
    """Where a component vanishes; of a point of a circle modulo its period."""
    if name not in getattr(system, "periods", {}):
        n = len(component_names(system, as_field(system).n_components))
        return _surface(name, asdict(TapeFunction(n, (), (k,))))
    return _surface(name, asdict(tape_of_surface(system, name)), modulus_of_surface(system, name))


def _surface(name: str, functions: dict[str, Any], modulus: Any = None) -> dict[str, Any]:
    """A surface by its name, as a function with its guard, and the number modulo which it is given, as text."""
    return {"name": name, "functions": functions, "modulus": None if modulus is None else _number(modulus)}


def _number(exact: Any) -> str:
    """A number as people write it, such as 2π/3; in six digits where that is too long."""
    text = str(exact).replace("*pi", "π").replace("pi", "π")
    return text if len(text) <= _LONGEST_MODULUS else f"{float(exact):.6g}"


def _several(given: Any) -> list[Any]:
    """Surfaces that were given as one or several, in their order."""
    if isinstance(given, str) or is_sympy(given):
        return [given]
    several = list(sequence(given, "surfaces", "formulas", "('l1*l2', 'l3'), or leave them out"))
    for one in several:
        if not isinstance(one, str) and not hasattr(one, "free_symbols") and not hasattr(one, "expression"):
            raise ParameterError(
                f"surfaces must be formulas, such as ('l1*l2', 'l3'); got {shown(one)}. Leave them out for none."
            )
    return several


def _shortened(names: list[str]) -> list[str]:
    """Names that the page can show, no two of them alike."""
    short = [name[:_LONGEST_NAME] for name in names]
    return [f"{text[: _LONGEST_NAME - 8]} ({k})" if short.count(text) > 1 else text for k, text in enumerate(short, 1)]


def _default_surface(system: Any, start: Array) -> tuple[str, str]:
    """Name and formula of that of `liepoisson section`; a component where there is none."""
    names = component_names(system, start.size)
    if not has_bracket(system):
        return names[0], names[0]
    bracketed: Any = system
    from liepoisson.leaf.starts import find
    from liepoisson.poincare.default_surface import surface_and_reason

    try:
        leaf = find(bracketed, start=start, guess=None, leaf=None, energy=None, seed=0).leaf
        surface, reason = surface_and_reason(leaf, None)
        bracketed.function_tape(surface)  # its numbers may be too long to be read
    except LiePoissonError:
        return names[0], names[0]
    return (surface if surface in names else reason.removeprefix("the ")), surface


def unit_of(system: Any, start: Array) -> float:
    """The unit of time of the page: twice the natural time of the orbit, as 1, 2 or 5 times a power of ten."""
    from liepoisson.numeric.time_scale import time_scale, unit_of_time

    try:
        natural = 2.0 * float(unit_of_time(time_scale(system, start[None], threads=1, time_limit=5.0)))
    except LiePoissonError:
        return 1.0
    if not (math.isfinite(natural) and 1e-6 < natural < 1e6):
        return 1.0
    power = math.floor(math.log10(natural))
    digits = (1, 2, 5, 10)
    digit = min(digits, key=lambda one: abs(math.log(natural / 10.0**power / one)))
    return float(f"{digit}e{power}")


def _start(system: Any, n: int, start: ArrayLike | Mapping[str, Any] | None) -> Array:
    if start is None:
        from liepoisson.numeric.sampling import sample_states

        return sample_states(system, 1, seed=0)[0]
    if hasattr(system, "component_names") and named(start, "start") is not None:
        start = read_state(system, start)
    return checked_start(cast("ArrayLike", start), component_names(system, n))


def checked_start(start: ArrayLike, components: Sequence[str]) -> Array:
    """A start as the page shows it, shape (component,)."""
    state = as_array(start, "start", components)
    if state.shape != (len(components),):
        raise ShapeError(f"start must have {len(components)} components, as the system has; got shape {state.shape}.")
    if not np.isfinite(state).all() or np.abs(state).max() > LARGEST:
        raise ParameterError(f"start must have numbers up to {LARGEST:g}, as the page shows them. Rescale the system.")
    return state


def _check_size(system: Any, n: int, terms: int) -> None:
    for count, most, noun in ((n, MOST_COMPONENTS, "components"), (terms, MOST_TERMS, "terms in its field")):
        if count > most:
            raise ParameterError(
                f"a system in the laboratory must have at most {most} {noun}; {system.name!r:.60} has {count}. "
                "Use `liepoisson orbit` or the functions of the package."
            )


def _terms(field: Any) -> int:
    """As the page counts them: entries and the numbers in them."""
    from liepoisson.compile.field import record_of

    total = 0
    for part in record_of(field).values():
        if not isinstance(part, (list, tuple)):
            continue
        total += len(part)
        for line in part:
            if isinstance(line, (list, tuple)):
                total += sum(len(inner) for inner in line if isinstance(inner, (list, tuple)))
    return total


def shortest(value: float) -> str:
    """The shortest text of a double, as the page writes it: 0 without a sign."""
    text = repr(float(value) + 0.0)
    return text.removesuffix(".0")


def _carrying(element: str) -> str:
    before, place, after = _built().partition(_PLACE)
    return f"{before}{element}\n{place}{after}"


@cache
def _built() -> str:
    page = files("liepoisson.laboratory").joinpath("page", "index.html").read_text(encoding="utf-8")
    if page.count(_PLACE) != 1:
        raise AssertionError("the built page has another form; make page builds it")
    return page
