"""Command lines and the files that they name, as a hostile user would write them; for fuzzing and for Hypothesis.

What to write is chosen by a source with two methods, `pick(items)` and `whole(least, most)`, so that one generator
serves a random number generator and Hypothesis.  `run` runs a command in this process and says what a user
would complain of.
"""

import contextlib
import io
import os
import sys
import time
from pathlib import Path

from hostile_names import FAMOUS, REFUSED

from liepoisson.cli.exit import UNEXPECTED
from liepoisson.cli.main import main
from liepoisson.numeric.methods import CHOICES

NAMES = [*FAMOUS, *(name for name in REFUSED if len(name) < 1000), "l", "alpha", "I", "a", "epsilon", "K", "p_psi"]
TEXTS = [
    *NAMES, "$", "$$", r"$\nosuch{y}$", "$" + "{" * 300 + "x" + "}" * 300 + "$", r"a $x_1$ b", "a__b", "_hidden",
    r"\frac{", "^_{}%&#~", "\x1b[31mred", "a\tb\nc", "\u202egnp.exe", "\U0001f600", "n" * 300, "n" * 5000, "../up",
    "C:\\x", "-", "--", "-h", "%s%n{0}{x}", "'; import os", '"""', "nan", "inf", "-inf", "None", "0", "C1=1", "H",
    "l1", "dot(l, l)", "l3 - 1/2", "sin(",
]  # fmt: skip
NUMBERS = [
    "0", "1", "-1", "2", "3", "0.5", "-0.0", "5e-324", "1e-300", "1e-20", "1e308", "1e309", "-1e308", "nan", "inf",
    "-inf", "1e", "", " ", "1/3", "sqrt(2)", "pi", "e", "٣", "1_000", "0x10", "2147483648", "9223372036854775808",
    "1" * 400, "x",
]  # fmt: skip
FORMULAS = [
    "dot({f}, {f})/2", "dot({f}, inv({p})*{f})/2", "{p}*{f}1*{f}2", "exp({p}*{f}1)", "asin({f}1/10) + {f}2^3",
    "({f}1 + {f}2 + {f}3)^20", "sqrt(dot({f}, {f}) + 1) + {p}*{f}3", "{p}", "exp(1)*{p}*{f}1 + pi*{f}2", "{t}",
    "1/{f}1",
]  # fmt: skip
SURFACES = ["l3", "l1 - 1/2", "sin(10^12*l1)", "H", "C1", "0", "pi", "l1*l2", "e", "{t}"]
SYSTEMS = ["free-rigid-body", "heavy-top", "twisted-kovalevskaya", "kovalevskaya", "twisted-top", "neumann"]
QUANTITIES = ["exponent", "chaotic_fraction", "os:system", "math:sqrt", "nosuch:f", ":", "builtins:print"]

_WHERE = {"--start": "state", "--leaf": "leaf", "--energy": "number", "--seed": "number", "--set": "setting"}
_FILES = {"--out": "out", "--figure": "figure", "--plot": None}
_STARTS = {"--starts": ["1", "2", "0", "-1", "x"]}
_FORMAT = {"--format": ["json", "text", "latex", "x"]}
OPTIONS = {
    "catalog": _FORMAT,
    "cite": {"--format": ["text", "bibtex", "json", "x"]},
    "inspect": _FORMAT | {"--set": "setting"},
    "orbit": _WHERE | _FILES | {
        "--guess": "state", "--t-end": "number", "--points": ["2", "3", "5", "0", "-1", "x"],
        "--method": [*CHOICES, "x"], "--tol": "number", "--step": ["0.1", "1", "0", "nan", "x"], "--order": "number",
    },
    "section": _WHERE | _FILES | {
        "--surface": "surface", "--t-end": ["10", "5e-324", "-1", "nan", "0"],
        "--crossings": ["3", "1", "0", "-1", "x"], "--starts": ["2", "0", "x"],
        "--keep": "text", "--x": "text", "--y": "text",
        "--method": [*CHOICES, "x"], "--tol": "number", "--step": ["0.1", "1", "0", "nan", "x"], "--order": "number",
    },
    "lyapunov": _WHERE | _FILES | _STARTS | {
        "--t-end": "number", "--ensemble": "text", "--tol": "number", "--spectrum": None,
    },
    "decide": _WHERE | _STARTS | _FORMAT | {"--t-end": "number"},
    "relax": _WHERE | {"--guess": "state", "--along": "setting", "--t-end": "number"},
    "equilibria": _STARTS | _FORMAT | {"--start": "state", "--leaf": "leaf", "--along": "setting"},
    "painleve": _FORMAT | {
        "--weights": ["1,1,1,2,2,2", "1,1,1,2,2,2,3,3,3", "1", "x", "-1,2", "1/2,1/2,1/2"], "--free": "text",
        "--set": "setting",
    },
    "sweep": {"--figure": "figure", "--plot": None, "--fresh": None, "--threads": ["1", "0", "x"], "--store": "store"},
    "reproduce": {"--nosuch": "text"},
}  # fmt: skip
ALWAYS = {name: ["--time-limit", "0.5"] for name in ("orbit", "section", "lyapunov", "decide", "relax", "painleve")}
"""So that no run is long; a command that is given it twice refuses it, which is one more case."""


class Source:
    """Chooses by Python's random numbers."""

    def __init__(self, random):
        self._random = random

    def pick(self, items):
        """One of a sequence."""
        return items[self._random.randrange(len(items))]

    def whole(self, least, most):
        """A whole number between two, both included."""
        return self._random.randint(least, most)


def mostly(source, usual, others):
    """One of the usual items, or in one of four cases one of the others."""
    return source.pick(usual) if source.whole(0, 3) else source.pick(others)


def quoted(text):
    """A text as a basic string of TOML, with what TOML cannot hold left out."""
    kept = "".join(c for c in text if not 0xD800 <= ord(c) <= 0xDFFF)
    inside = "".join(f"\\U{ord(c):08x}" if ord(c) < 32 or c in '"\\\x7f' else c for c in kept)
    return f'"{inside}"'


def system_file(source):
    """A file of a system whose names, title and formula are hostile."""
    field, parameter = mostly(source, FAMOUS, NAMES), mostly(source, FAMOUS, NAMES)
    text = source.pick(TEXTS)
    formula = source.pick(FORMULAS).format(f=field, p=parameter, t=text)
    value = mostly(source, ['"1/3"', "2", '"sqrt(2)"'], ["[1, 2, 3]", quoted(source.pick(NUMBERS)), "1e400", "nan"])
    lines = [f"name = {quoted(source.pick(TEXTS))}"] if source.whole(0, 3) else []
    lines += ["[bracket]"]
    if source.whole(0, 2):
        lines += ['algebra = "so(3)"']
    else:
        lines += [
            "structure_constants = [[[0,0,0],[0,0,1],[0,-1,0]],[[0,0,-1],[0,0,0],[1,0,0]],[[0,1,0],[-1,0,0],[0,0,0]]]"
        ]
        lines += [f"basis_names = [{', '.join(quoted(source.pick([*NAMES, '1', '2', '3'])) for _ in range(3))}]"]
    lines += [f"variables = [{quoted(field)}]"]
    lines += ["[parameters]", f"{quoted(parameter)} = {value}"]
    lines += ["[hamiltonian]", f"expression = {quoted(formula)}"]
    if not source.whole(0, 3):
        lines += [
            "[integrals]",
            f"{quoted(source.pick(TEXTS))} = {quoted(source.pick(FORMULAS).format(f=field, p=parameter, t=text))}",
        ]
    return "\n".join(lines)


def sweep_file(source):
    """A small sweep with hostile names and labels."""
    name = mostly(source, ["epsilon", "a1", "energy", *FAMOUS], NAMES)
    lines = [f"system = {quoted(mostly(source, ['twisted-kovalevskaya'], ['twisted-top', 'system.toml', 'nosuch']))}"]
    lines += [f"n_starts = {mostly(source, ['1', '2'], ['2147483648', '0', '-1', quoted('x')])}"]
    lines += [
        f"t_end = {mostly(source, ['1', '2.5', quoted('pi')], ['5e-324', '0', 'nan', quoted(source.pick(TEXTS))])}"
    ]
    if not source.whole(0, 3):
        lines += [f"quantity = {quoted(source.pick(QUANTITIES))}"]
    if source.whole(0, 1):
        lines += [f"name = {quoted(source.pick(TEXTS))}"]
    if source.whole(0, 1):
        lines += [
            "[parameters]",
            f"epsilon = {quoted(source.pick(['exp(1)*{0}', '{0}', 'asin({0})', '1/{0}', '{0}^64']).format(name))}",
        ]
    lines += [
        "[[axes]]",
        f"name = {quoted(name)}",
        f"values = {mostly(source, ['[0.5, 1]', '[0.25]'], ['[]', '[1, nan]', '[1e308, 2]'])}",
    ]
    if source.whole(0, 1):
        lines += [f"label = {quoted(source.pick(TEXTS))}"]
    if not source.whole(0, 4):
        lines += [
            "[[axes]]",
            'name = "a1"',
            "from = 0",
            "to = 1",
            f"count = {source.pick(['2', '16384', '268435456', '1', '0'])}",
        ]
    return "\n".join(lines)


def value_of(source, kind):  # noqa: PLR0911  # one for each kind
    """The value of an option."""
    if isinstance(kind, list):
        return mostly(source, kind[:2], kind)
    number = mostly(source, NUMBERS[:9], NUMBERS)
    if kind == "number":
        return number
    if kind == "setting":
        return f"{source.pick(NAMES)}={source.pick([number, f'{number},0,1', f'[{number}]', ''])}"
    if kind == "state":
        name = source.pick(["l", *NAMES])
        number = mostly(source, ["0.1", "1/3", "1"], NUMBERS)
        return source.pick(
            [
                f"{name}=0.1,0.2,0.3",
                f"{name}1={number}",
                ",".join([number] * source.pick([1, 3, 9])),
                source.pick(TEXTS),
            ]
        )
    if kind == "leaf":
        return source.pick([f"C1={number}", f"C1={number},C2=0", f"{source.pick(NAMES)}={number}", source.pick(TEXTS)])
    if kind == "surface":
        return source.pick(SURFACES).format(t=source.pick(TEXTS))
    if kind in ("out", "figure", "store"):
        stem = source.pick(
            ["o", "o\udcff", "x" * 300, "a/b", "", " ", ".", "..", "o$", "système", "a\nb", "/dev/full", "/proc/x"]
        )
        return stem + source.pick(
            {"out": [".nc", ".csv", "", ".txt"], "figure": [".png", "", ".jpg"], "store": [".zarr", ""]}[kind]
        )
    return source.pick(TEXTS)


def command(source):
    """The arguments of a command and the files that it may read, by their names."""
    name = source.pick([*OPTIONS, *["orbit", "section", "sweep", "inspect", "lyapunov"] * 2])
    files = {"system.toml": system_file(source), "sweep.toml": sweep_file(source), "b\udcff.toml": system_file(source)}
    arguments = [name]
    if name == "sweep":
        arguments += [mostly(source, ["sweep.toml"], ["system.toml", source.pick(TEXTS)])]
    elif name not in ("catalog", "reproduce"):
        arguments += [mostly(source, ["system.toml", "b\udcff.toml", *SYSTEMS], TEXTS)]
    options = OPTIONS[name]
    for option in dict.fromkeys(source.pick([*options]) for _ in range(source.whole(0, 3))):
        arguments += [option] if options[option] is None else [option, value_of(source, options[option])]
    if name in ("lyapunov", "decide") and not {"--starts", "--start"} & {*arguments}:
        arguments += ["--starts", "2"]
    if name == "section" and "--starts" not in arguments and "--start" not in arguments:
        arguments += ["--starts", "2"]
    if name == "section" and "--crossings" not in arguments:
        arguments += ["--crossings", "3"]
    if not source.whole(0, 9):
        arguments.insert(source.whole(0, len(arguments)), source.pick(TEXTS))
    if name == "reproduce":
        arguments += ["--nosuch"]  # never the hours of work that it does without
    arguments += ALWAYS.get(name, [])
    return [argument.replace("\x00", "") for argument in arguments], files


class ComplaintError(AssertionError):
    """What a user would complain of."""


def run(arguments, files, folder, *, seconds):
    """Run a command in a folder, in this process; its exit code and what it printed.

    Raises:
        ComplaintError: a traceback, an exit code that is not documented, no reason given, or too long a run.
    """
    for name, text in files.items():
        Path(folder, name).write_text(text, encoding="utf-8", errors="replace")
    out, err = (io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True) for _ in range(2))
    before, argv, began = os.getcwd(), sys.argv, time.process_time()
    code = None
    try:
        os.chdir(folder)
        sys.argv = ["liepoisson", *arguments]
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            main()
    except SystemExit as end:
        code = end.code or 0
    except BaseException as error:
        raise ComplaintError(f"{arguments!r} raised {type(error).__name__}: {error}") from error
    finally:
        os.chdir(before)
        sys.argv = argv
    said = err.buffer.getvalue().decode("utf-8", "replace")
    taken = time.process_time() - began
    for wrong, words in (
        (code not in (0, 1, 2), f"exit code {code}"),
        (UNEXPECTED in said or "Traceback" in said, "an unexpected error"),
        (code == 2 and not said.strip(), "no reason"),
        (len(said) > 30_000, "a message of pages"),
        (taken > seconds, f"{taken:.1f} s"),
    ):
        if wrong:
            contents = "\n--\n".join(files.values())
            raise ComplaintError(f"{words}: {arguments!r}\n{contents}\n--\n{said[-2000:]}")
    return code, out.buffer.getvalue().decode("utf-8", "replace"), said
