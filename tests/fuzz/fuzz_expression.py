"""Fuzzing of the parser of formulas and of system files with atheris; run by hand, not by pytest.

    python -m venv venv && venv/bin/pip install atheris sympy numpy python-flint
    PYTHONPATH=python venv/bin/python tests/fuzz/fuzz_expression.py grammar -runs=1000000 -max_len=200 -seed=1
    PYTHONPATH=python venv/bin/python tests/fuzz/fuzz_expression.py formula -runs=100000 -max_len=100 -seed=1
    PYTHONPATH=python venv/bin/python tests/fuzz/fuzz_expression.py file -runs=100000 -max_len=400 -seed=1

`grammar` stops at the tree, `formula` goes on to SymPy, `file` reads a system file.  A run fails when a text
makes anything but an error of ours, when one input takes too long, or when the audit hook sees an event that only the
running of code makes: an import, a compilation, an open file, a new process, a connection.  The input at fault, and
slow ones, are kept in a folder for temporary files, which is printed first; -artifact_prefix=FOLDER/ names another.
"""

import importlib
import os
import pkgutil
import re
import sys
import tempfile
import time
from fractions import Fraction

import atheris

with atheris.instrument_imports(include=["liepoisson", "tomllib"]):
    from liepoisson.errors import ExpressionError, SystemFileError
    from liepoisson.formula.expression import read_formula
    from liepoisson.formula.grammar import parse
    from liepoisson.formula.scope import Scope
    from liepoisson.model.system_file_reader import parse_system_file

FORBIDDEN = (
    "import",
    "exec",
    "compile",
    "open",
    "os.",
    "subprocess.",
    "socket.",
    "ctypes.",
    "pty.",
    "shutil.",
    "code.",
)

PIECES = re.findall(
    r"\S+",
    """
    l alpha beta l1 alpha[2] M12 M[3] I I1 a a3 epsilon n A A[1,2] pi x 0 1 2 64 0.5 1e3 1e-3 1e400 1/3 + - * / ^ **
    ( ) [ ] , + - * / ^ ( ) l1 alpha2 beta3 2 3
    dot( cross( norm( diag( inv( transpose( trace( sqrt( exp( log( sin( cos( tan( sinh( cosh( tanh( asin( acos( atan(
    abs( __import__( l.x __class__ lambda: ' " = # _ @ ; { } \\ \u03b1 \u00b2 \u2212 \u00d7
    """,
)
FILE_PIECES = [
    *re.findall(
        r"\S+",
        """
        name="x" [bracket] [parameters] [hamiltonian] [integrals] [[reference]] algebra="so(3)" W=[[[1]]] W=[[["e"]]]
        algebra="so(2,1)+so(3)" extension="leibniz(3,epsilon)" extension="semidirect(2)" extension="crmhd(2)" epsilon=1
        variables=["l","alpha","beta"] I=[1,2,"3/2"] a=[0,0,1] symbols=["epsilon","a[3]"] expression="dot(l,inv(I)*l)/2"
        expression="dot(l,l)/2+dot(a,alpha)" K="l3" K={expression="l3",on="dot(l,alpha)=0"} quantity="H" value=1
        value="1/2" state=[1,2,3] state={l=[1,2,3]} tolerance=1e-3 structure_constants=[[[0]]] matrices=[[[0,1],[0,0]]]
        [ ] { } = , " ' . # 0x10 nan inf 1e999 1979-05-27 true basis_names=["1"] source="s" description="d" a.b.c=1
        """,
    ),
    *["\n"] * 20,
]
START = (
    '[bracket]\nalgebra="so(3)"\nextension="leibniz(3,epsilon)"\n[hamiltonian]\nexpression="dot(l,l)/2"\n[parameters]\n'
)
# Texts that load what is loaded at first use only, before the audit hook looks.
WARM_FORMULAS = (
    "dot(l, inv(A)*l) + tan(l1 + pi/2)",
    "sqrt(2)*exp(l1)^(1/3)",
    "norm(l)^n",
    "trace(inv(B))",
    "lx + sqrt(sqrt(2) - 1)",
    "asin(sin(1)) + log(2*pi) + acos(1/2) + atan(1) + sinh(1) + cosh(1) + tanh(1) + cos(pi/7)",
    "sqrt(-2)",
)
WARM_FILES = (
    '[bracket]\nalgebra="so(3)+so(2,1)"\nextension="crmhd(beta)+trivial()"\n[parameters]\nbeta=1\n[hamiltonian]\n'
    'expression="sqrt(dot(omega,omega)+1)"',
    START + 'epsilon="2*pi/3"',
    START + "epsilon=1",
    START + 'symbols=["epsilon"]\n[integrals]\nK={expression="l3",on="l1=l2"}',
    '[bracket]\nmatrices=[[[0,1],[0,0]]]\nW=[[[1]]]\n[parameters]\nI=[1]\n[hamiltonian]\nexpression="l1/I1"',
    '[bracket]\nmatrices=[[[0,"e"],[0,0]]]\nW=[[["e"]]]\n[parameters]\nsymbols=["e"]\n[hamiltonian]\nexpression="l1"',
    '[bracket]\nalgebra="sine(3)"\nextension="normal_form(3,1)"\n[hamiltonian]\nexpression="pi"',
    "a=nan\nb=1979-05-27\nc=07:32:00\nd=1e5",
)


SCALARS = ["l1", "beta3", "M12", "I1", "A[1,2]", "epsilon", "n", "pi", "2", "1/3", "0", "64", "0.1", "1e150", "(-1)"]
VECTORS = ["l", "alpha", "a", "inv(I)*l", "A*l", "inv(A)*alpha", "B*l"]
# Rules for formulas that have a meaning, or nearly so: s stands for a scalar, v for a vector.
RULES = (
    *("(s+s)", "(s-s)", "s*s", "s/s", "(s)^2", "(s)^(1/2)", "(s)^-1", "(s)^s", "(s)^64", "-s", "dot(v,v)", "norm(v)"),
    *(
        "sqrt(s)",
        "exp(s)",
        "log(s)",
        "sin(s)",
        "cos(s)",
        "tan(s)",
        "sinh(s)",
        "tanh(s)",
        "asin(s)",
        "acos(s)",
        "atan(s)",
    ),
    *("trace(inv(diag(v)+A))", "cross(v,v)[1]", "dot(s*v,cross(v,v)/s)", "dot(v,inv(diag(v)+B)*v)", "(s+s+s+s)^8"),
)


def meaningful(provider, depth=0):
    """A formula made by the rules."""
    if depth > 8 or provider.remaining_bytes() == 0 or provider.ConsumeIntInRange(0, 3) == 0:
        return provider.PickValueInList(SCALARS)
    rule = provider.PickValueInList(list(RULES))
    parts = re.split(r"(?<![a-z])([sv])(?![a-z])", rule)
    made = {"s": lambda: meaningful(provider, depth + 1), "v": lambda: provider.PickValueInList(VECTORS)}
    return "".join(made[part]() if part in made else part for part in parts)


class Target:
    """One way to read texts, with its statistics."""

    def __init__(self, name):
        half = Fraction(1, 2)
        scope = Scope(
            {"l": "123", "alpha": "123", "beta": "123", "M": ("12", "13", "14", "23", "24", "34")},
            {"I": (2, 2, 1), "a": (-1, 0, half), "A": ((1, 2, 0), (0, 1, 0), (half, 0, 3))},
            ("epsilon", "n", "B[3,3]"),
        )
        self.name = name
        self.read, self.refused, self.time_limit, self.pieces = {
            "grammar": (parse, ExpressionError, 1.0, PIECES),
            "formula": (lambda text: read_formula(text, scope), ExpressionError, 5.0, PIECES),
            "file": (lambda text: parse_system_file(text).system(), SystemFileError, 10.0, FILE_PIECES),
        }[name]
        self.reading = False
        self.inputs = self.accepted = 0
        self.slowest = 0.0
        self.started = time.process_time()

    def warm_up(self):
        for name in ("assumptions", "core", "functions", "matrices", "polys", "simplify"):
            folder = importlib.import_module(f"sympy.{name}").__path__
            for module in pkgutil.walk_packages(folder, f"sympy.{name}."):
                if ".tests" not in module.name and ".benchmarks" not in module.name:
                    importlib.import_module(module.name)
        for text in (*PIECES, *WARM_FORMULAS, *WARM_FILES):
            try:
                self.read(text)
            except self.refused:
                continue

    def audit(self, event, arguments):
        if self.reading and event.startswith(FORBIDDEN):
            sys.stderr.write(f"FORBIDDEN EVENT {event} {arguments!r:.200}\n")
            os.abort()

    def text_from(self, data):
        """Arbitrary text, or for a part of the inputs a sequence of pieces of the language."""
        provider = atheris.FuzzedDataProvider(data)
        kind = provider.ConsumeIntInRange(0, 5)
        if kind == 0:
            return provider.ConsumeUnicodeNoSurrogates(len(data))
        if kind > 3:
            text = meaningful(provider)[:5000]
            return START.replace("dot(l,l)/2", text) + "epsilon=1" if self.name == "file" else text
        chosen = [
            self.pieces[provider.ConsumeIntInRange(0, len(self.pieces) - 1)]
            for _ in range(min(provider.remaining_bytes(), 60))
        ]
        text = (" " if kind == 1 else "").join(chosen)
        return START + text if self.name == "file" and kind == 3 else text

    def test(self, data):
        text = self.text_from(data)
        begin = time.process_time()
        self.reading = True
        try:
            self.read(text)
            self.accepted += 1
        except self.refused:
            pass
        finally:
            self.reading = False
        taken = time.process_time() - begin
        self.inputs += 1
        self.slowest = max(self.slowest, taken)
        if taken > self.time_limit:
            raise AssertionError(f"{taken:.1f} s for {text!r}")
        if self.inputs % 50_000 == 0:
            self.report()

    def report(self):
        rate = self.inputs / (time.process_time() - self.started)
        sys.stderr.write(
            f"{self.name}: {self.inputs} inputs, {self.accepted} accepted, {rate:.0f} per second, "
            f"slowest {self.slowest:.3f} s\n"
        )


def main():
    target = Target(sys.argv.pop(1))
    if not any(argument.startswith("-artifact_prefix=") for argument in sys.argv):
        sys.argv.append(f"-artifact_prefix={tempfile.mkdtemp(prefix='fuzz-expression-')}/")
        sys.stderr.write(f"{sys.argv[-1]}\n")
    target.warm_up()
    sys.addaudithook(target.audit)
    atheris.Setup(sys.argv, target.test)
    atheris.Fuzz()


if __name__ == "__main__":
    main()
