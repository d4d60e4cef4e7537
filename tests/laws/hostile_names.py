"""Names that mean something to SymPy, NumPy, Python or us, and what must become of them as names of a user."""

import keyword
import string

import numpy as np
import sympy

from liepoisson.inputs.names import CONSTANTS, FUNCTIONS

# What SymPy, NumPy, Python and C call their constants and functions, what code printers write or reserve, and what
# texts of ours call things.
FAMOUS = (
    "e", "E", "I", "N", "S", "Q", "O", "C", "H", "i", "j", "n", "t", "x", "y", "z", "d", "w", "p", "q", "oo", "nan",
    "inf", "Inf", "zoo", "Pi", "PI", "NaN", "beta", "gamma", "zeta", "alpha", "lambda", "Lambda", "lambda_",
    "epsilon", "omega", "theta", "eta", "abs", "Abs", "max", "min", "sum", "log2", "log10", "ln", "arcsin",
    "arccos", "arctan", "arctan2", "power", "sign", "sinc", "where", "select", "less", "greater", "piecewise",
    "Piecewise", "Symbol", "Dummy", "Function", "true", "false", "numpy", "np", "math", "sympy", "array", "linalg",
    "reduce", "ones", "zeros", "full", "dtype", "float64", "newaxis", "print", "eval", "exec", "open", "input",
    "type", "id", "len", "range", "object", "self", "cls", "__debug__", "__name__", "__import__", "__builtins__",
    "__class__", "__dict__", "__init__", "__doc__", "_", "__", "___", "_0", "_1", "_00", "_c0", "x0", "x1", "x_0",
    "_x0", "_Dummy_1", "_lambdifygenerated", "None", "True", "False", "energy", "time", "state", "value", "outcome",
    "member", "point", "component", "trajectory", "mean", "level", "index", "name", "seed", "system", "generic",
    "everywhere", "so", "su", "algebra", "extension", "trivial", "leibniz", "variables", "Cse", "cse", "Catalan",
    "EulerGamma", "GoldenRatio", "Float", "Rational", "Integer", "re", "im", "conjugate", "degrees", "pi_", "PI_",
    "pi2", "sin_", "sqrt2",
)  # fmt: skip

REFUSED = (
    *FUNCTIONS, *CONSTANTS, "", " ", "a b", "1a", "1", "a-b", "a.b", "a[3]", "a$", "$", "\\pi", "l1+l2", "x\n", "\x00",
    "é", "ε", "π", "ﬁ", "ⅷ", "ᵉ", "ｅ", "𝐞", "𝟏", "\u0435", "l’", "a\u200b", "a\u0301", "\ud800", "e" * 101,
    "e" * 200_000, "__import__('os')",
)  # fmt: skip
"""Functions and constants of formulas, what is no identifier, look-alikes (also such as become another name by Unicode
normalisation: the ligature fi, the full-width and the bold e; the Cyrillic one does not), and what is too long."""


def accepted() -> list[str]:
    """Every name that must be as good as any other."""
    names = {
        *FAMOUS,
        *keyword.kwlist,
        *keyword.softkwlist,
        *dir(__builtins__ if not isinstance(__builtins__, dict) else __builtins__["__build_class__"].__self__),
        *string.ascii_letters,
        *(name for name in dir(np) if name.isidentifier()),
        *(name for name in dir(sympy) if name.isidentifier()),
        *sympy.functions.__all__,
        "e" * 100,
    }
    return sorted(names - {*FUNCTIONS, *CONSTANTS})
