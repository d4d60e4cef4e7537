"""Names: which ones formulas keep for themselves, and which ones a user may choose.

There is one rule, for parameters, their components, symbols, fields, coordinates, canonical coordinates and the axes of
sweeps: a name consists of ASCII letters, digits and `_`, does not begin with a digit, has at most 100 characters, and
is none of the functions and constants below.  Every other name is free, and stands for what the user says and for
nothing else: `e`, `E`, `I`, `N`, `S`, `lambda` and `beta` mean nothing by themselves.
"""

from __future__ import annotations

import re
from collections.abc import Collection

from liepoisson.errors import ParameterError

ELEMENTARY_FUNCTIONS = (
    "sqrt", "exp", "log", "sin", "cos", "tan", "sinh", "cosh", "tanh", "asin", "acos", "atan",
)  # fmt: skip
MATRIX_FUNCTIONS = ("dot", "cross", "norm", "diag", "inv", "transpose", "trace")
ANGLE = "atan2"
"""The angle of a pair, which jumps: for functions of sections and figures, not for Hamiltonians."""
FUNCTIONS = (*MATRIX_FUNCTIONS, *ELEMENTARY_FUNCTIONS, ANGLE)
CONSTANTS = ("pi",)
NOT_FINITE = frozenset({"nan", "inf", "infinity"})
"""What others write for no number, in small letters: never a symbol where a number is read."""

NOT_SMOOTH = {
    "abs", "fabs", "sign", "sgn", "min", "max", "floor", "ceil", "ceiling", "round", "trunc", "int", "frac", "fract",
    "mod", "fmod", "heaviside", "step", "theta", "piecewise", "where", "if", "relu", "delta", "dirac", "diracdelta",
}  # fmt: skip
"""Functions that formulas refuse, in lower case: here and in SymPy's."""

PARTIAL_FUNCTIONS = ("log", "sqrt", "asin", "acos", "norm")
"""Functions of formulas that are no real numbers, or not smooth, at some real arguments."""

GREEK = (
    "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
    "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
)  # fmt: skip
"""Greek letters in the order of their code points; sigma stands twice for its final form."""

TIME, MOMENTUM_OF_TIME = "t", "p_t"
"""How time is called in a Hamiltonian that depends on it, and its momentum."""

MAX_NAME = 100
"""Characters of the longest name."""

MAX_TITLE = 200
"""Characters of the longest name of a system, which is a text for people."""

_IDENTIFIER = re.compile(r"[A-Za-z_][A-Za-z_0-9]*")


def is_identifier(name: str) -> bool:
    """Whether formulas can have this name, as far as its characters go."""
    return _IDENTIFIER.fullmatch(name) is not None


def check_name(name: object, what: str = "a name") -> str:
    """The name, if a user may choose it.

    Args:
        name: What the user chose.
        what: What kind of name it is, at the beginning of a message: "a field name".

    Raises:
        ParameterError: it is no identifier, too long, or the name of a function or constant of formulas.
    """
    if not isinstance(name, str) or not is_identifier(name):
        hint = f'Write the text "{name}".' if not isinstance(name, str) and is_identifier(str(name)) else "Rename it."
        raise ParameterError(
            f"{what} must consist of letters, digits and _ (of ASCII), and not begin with a digit; "
            f"got {name!r:.60}. {hint}"
        )
    if len(name) > MAX_NAME:
        raise ParameterError(
            f"{what} must have at most {MAX_NAME} characters; got {len(name)}: {name[:20]}... Shorten it."
        )
    check_not_reserved(name, what)
    return name


def check_title(title: object, what: str, most: int | None = MAX_TITLE) -> str:
    """How something is called in texts and files, if these keep it exactly.

    Args:
        title: What the user chose: one line of printable characters, words one blank apart.
        what: Whose name it is, at the beginning of a message: "the name of a system".
        most: Characters of the longest; None for what is not read from files.

    Raises:
        ParameterError: it is no text, empty, of several lines, too long, or has characters that cannot be printed.
    """
    if not isinstance(title, str):
        raise ParameterError(f'{what}: wanted a text; got {title!r:.60}; write for example "heavy top"')
    if not title:
        raise ParameterError(f'{what}: wanted a text that is not empty; got {title!r}; write for example "heavy top"')
    if not title.isprintable() or " ".join(title.split()) != title:
        raise ParameterError(
            f"{what}: wanted one line of printable characters, with single blanks between words; got {title!r:.60}; "
            "remove the others"
        )
    if most is not None and len(title) > most:
        raise ParameterError(f"{what} must have at most {most} characters; got {len(title)}. Shorten it.")
    return title


def free_name(wanted: str, taken: Collection[str]) -> str:
    """The wanted name for a symbol of a report, with as many `_` behind it as make it differ from names of users."""
    while wanted in taken:
        wanted += "_"
    return wanted


def check_not_reserved(name: str, what: str = "a name") -> None:
    """Refuse the names of functions and constants of formulas.

    Raises:
        ParameterError: it is one of these.
    """
    if name in FUNCTIONS or name in CONSTANTS:
        raise ParameterError(f"{what} must not be that of a function or constant of formulas; got {name}. Rename it.")
