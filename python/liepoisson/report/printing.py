r"""Formulas in plain text, in Unicode and in LaTeX, on one line each.

A `Formula` is a SymPy expression in which some symbols stand for vector expressions: $|\alpha|^2$, $\ell\cdot\beta$,
$\beta\times a$.  Which ones, and that they stand for what they should, is the matter of
`liepoisson.report.vector_notation`; here they are only written down.  Long rational numbers are decimals: 1e-320 is not
written with 320 zeros.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeAlias, cast

from liepoisson.formula.styles import LATEX, PLAIN, UNICODE, Style, split_name

if TYPE_CHECKING:
    from sympy import Expr, Symbol

    from liepoisson.structure.trace import Trace

LONG_NUMBER = 12
"""Characters of a number that is still written as a fraction, or with all its zeros."""


@dataclass(frozen=True)
class Decimal:
    """A positive or negative number, exactly: sign, digits and a power of ten."""

    mantissa: str  # its digits, with a sign and a point where there is one
    exponent: str = ""  # the power of ten, as text; empty if it is left out

    @classmethod
    def of(cls, value: Fraction) -> Decimal | None:
        """The decimal of a number with finitely many digits; None for any other."""
        rest, places = split_denominator(value.denominator)
        if rest != 1:
            return None
        digits = str(abs(value.numerator) * 10**places // value.denominator)
        sign = "-" if value < 0 else ""
        short = digits.rstrip("0") or "0"
        exponent = str(len(digits) - 1 - places)
        mantissa = short[0] + ("." + short[1:] if short[1:] else "")
        padded = digits.rjust(places + 1, "0")
        plain = f"{padded[:-places]}.{padded[-places:]}".rstrip("0").rstrip(".") if places else padded
        if len(plain) > LONG_NUMBER and len(mantissa) + len(exponent) + 1 < len(plain):
            return cls(sign + mantissa, exponent)
        return cls(sign + plain)

    def write(self, style: Any) -> str:
        """In plain text as 1.5e-320, which a formula may contain; otherwise with a power of ten."""
        from liepoisson.formula.styles import PLAIN

        if not self.exponent:
            return self.mantissa
        if style is PLAIN:
            return f"{self.mantissa}e{self.exponent}"
        power = style.power("10", self.exponent)
        return power if self.mantissa == "1" else f"{self.mantissa}{style.dot}{power}"


def split_denominator(denominator: int) -> tuple[int, int]:
    """The factor without 2 and 5, and how many decimal places the others take at most."""
    places = 0
    while denominator % 2 == 0 or denominator % 5 == 0:
        denominator //= 2 if denominator % 2 == 0 else 5
        places += 1
    return denominator, places


def long_number(numerator: int, denominator: int) -> tuple[Decimal, int] | None:
    """A fraction with long numbers as a decimal over what remains of the denominator; None if it is short as it is."""
    if max(len(str(abs(numerator))), len(str(denominator))) <= LONG_NUMBER:
        return None
    rest, _ = split_denominator(denominator)
    decimal = Decimal.of(Fraction(numerator * rest, denominator))
    return None if decimal is None or rest > 10**LONG_NUMBER else (decimal, rest)


@dataclass(frozen=True)
class Gradient:
    r"""The vector $\partial H/\partial x$ of one field x."""

    field: str


@dataclass(frozen=True)
class Shifted:
    r"""The difference or sum $x \pm r$ of a field x and a vector of parameters r."""

    field: str  # the field x
    sign: int  # 1 or -1
    by: str  # the vector r


Vector: TypeAlias = "str | Gradient | Shifted"


@dataclass(frozen=True)
class Square:
    r"""$|u|^2$."""

    u: Vector


@dataclass(frozen=True)
class Dot:
    r"""$u\cdot v$."""

    u: Vector
    v: Vector


@dataclass(frozen=True)
class Form:
    r"""$u\cdot D^{\pm1} v$ with a diagonal matrix D, or $u\cdot A v$ with any matrix A of parameters."""

    u: Vector
    matrix: str
    power: int
    v: Vector


@dataclass(frozen=True)
class Triple:
    r"""$u\cdot(v\times w)$."""

    u: Vector
    v: Vector
    w: Vector


@dataclass(frozen=True)
class Cross:
    r"""$u\times v$."""

    u: Vector
    v: Vector


@dataclass(frozen=True)
class Image:
    r"""$D^{\pm1} u$ with a diagonal matrix D, or $A u$ with any matrix A of parameters."""

    matrix: str
    power: int
    u: Vector


@dataclass(frozen=True)
class Itself:
    """A vector as a term of a sum."""

    u: Vector


Atom: TypeAlias = Square | Dot | Form | Triple | Cross | Image | Itself


@dataclass(frozen=True)
class Formula:
    r"""One scalar or vector expression, ready to be written."""

    expression: Expr  # in coordinates, parameters and the symbols listed in `atoms`
    atoms: Mapping[Symbol, Atom] = field(default_factory=dict[Any, Atom])  # what each formal symbol stands for
    # for each coordinate its field and basis name, in the order of the state: `{"l1": ("l", "1"), ...}`
    coordinates: Mapping[str, tuple[str, str]] = field(default_factory=dict[str, tuple[str, str]])

    def write(self, style: Style, most_terms: int | None = None) -> str:
        """The formula in one style, with the last of more than `most_terms` terms left out and counted."""
        return _Writer(self, style).sum(self.expression, most_terms)

    @property
    def plain(self) -> str:
        """In ASCII, for example "|alpha|^2 + 2 epsilon l.beta"."""
        return self.write(PLAIN)

    @property
    def unicode(self) -> str:
        """In Unicode, for example "|α|² + 2ε l·β"."""
        return self.write(UNICODE)

    @property
    def latex(self) -> str:
        r"""In LaTeX, for example `|\boldsymbol{\alpha}|^2 + 2 \epsilon\,\boldsymbol{\ell}\cdot\boldsymbol{\beta}`."""
        return self.write(LATEX)

    def __str__(self) -> str:
        return self.plain


def write_vector(vector: Vector, style: Style) -> str:
    """The name of a vector."""
    if isinstance(vector, Shifted):
        return f"{style.vector(vector.field)} {'-' if vector.sign < 0 else '+'} {style.vector(vector.by)}"
    return style.gradient(vector.field) if isinstance(vector, Gradient) else style.vector(vector)


def write_atom(atom: Atom, style: Style) -> str:
    """A vector expression."""
    match atom:
        case Square(u):
            text = style.power(f"|{write_vector(u, style)}|", "2")
        case Dot(u, v):
            text = write_vector(u, style) + style.dot + write_vector(v, style)
        case Form(u, matrix, power, v):
            text = write_vector(u, style) + style.dot + style.image(matrix, power, write_vector(v, style))
        case Triple(u, v, w):
            text = write_vector(u, style) + style.dot + style.parentheses(write_atom(Cross(v, w), style))
        case Cross(u, v):
            text = write_vector(u, style) + style.cross + write_vector(v, style)
        case Image(matrix, power, u):
            text = style.image(matrix, power, write_vector(u, style))
        case Itself(u):
            text = write_vector(u, style)
            text = style.parentheses(text) if isinstance(u, Shifted) else text
    return text


def write_trace(trace: Trace, style: Style) -> str:
    """A trace of a product of fields as matrices: tr(alpha^2 beta)."""
    runs = [style.vector(name) if n == 1 else style.power(style.vector(name), str(n)) for name, n in trace.text]
    return style.function(trace.function_name, " ".join(runs))


class _Writer:
    """Writes one formula in one style."""

    def __init__(self, formula: Formula, style: Style) -> None:
        self.atoms = formula.atoms
        self.coordinates = formula.coordinates
        self.style = style
        self.places = {name: place for place, name in enumerate(formula.coordinates)}

    def sum(self, expression: Expr, most_terms: int | None = None) -> str:
        from sympy import Add

        terms = _args(Add, expression)
        n_terms = len(terms)
        if n_terms > 1:
            terms.sort(key=self.rank)
            # A sum begins with a positive term if it has one.
            first = next((k for k, term in enumerate(terms) if not term.could_extract_minus_sign()), 0)
            terms.insert(0, terms.pop(first))
        if most_terms is not None and n_terms > most_terms:
            del terms[most_terms:]
        text = ""
        for term in terms:
            negative, body = self.signed(term)
            if text:
                text += (" - " if negative else " + ") + body
            else:
                text = ("-" if negative else "") + body
        return text if n_terms == len(terms) else text + self.style.left_out(n_terms - len(terms))

    def rank(self, term: Expr) -> tuple[Any, ...]:
        """High degrees come first, then terms with plain numbers in front, squares, and the order of the fields."""
        from sympy import Mul

        degree, powers, parameters = 0, [], False
        for factor in _args(Mul, term):
            base, exponent = _power_of(factor)
            place = self.place(base)
            if place is None:
                parameters |= bool(factor.free_symbols)
            elif exponent.is_Integer:
                size, position = place
                degree += size * int(exponent)
                powers.append((position, -int(exponent)))
        return -degree, parameters, sorted(powers), term.could_extract_minus_sign(), str(term)

    def place(self, base: Expr) -> tuple[int, tuple[Any, ...]] | None:
        """Degree in the coordinates, and position, of an atom or a coordinate; None for anything else."""
        if base in self.atoms:
            atom = self.atoms[cast("Symbol", base)]
            vectors = [v for v in vars(atom).values() if isinstance(v, (str, Gradient, Shifted))]
            kind = (Form, Square, Dot, Triple, Cross, Image, Itself).index(type(atom))
            fields = [self._field_place(v) for v in vectors]
            degree = 2 if isinstance(atom, Square) else sum(place < _NOT_A_FIELD - 1 for place in fields)
            # Names at the end, so that no order is left to chance.
            return degree, (0 if isinstance(atom, (Cross, Image, Itself)) else kind, *fields, *map(str, vectors))
        if getattr(base, "is_trace", False):
            return len(cast("Trace", base).word), (8, str(base))
        name = str(base)
        return (1, (9, self.places[name])) if name in self.places else None

    def _field_place(self, vector: Vector) -> int:
        names = [name for name, _ in self.coordinates.values()]
        if isinstance(vector, Shifted):
            return names.index(vector.field)
        if vector == "omega" and vector not in names:
            return _NOT_A_FIELD - 1
        return names.index(vector) if isinstance(vector, str) and vector in names else _NOT_A_FIELD

    def signed(self, term: Expr) -> tuple[bool, str]:
        """Whether the term is negative, and its absolute value."""
        from sympy import Mul, S

        number, rest = cast("tuple[Any, Expr]", term.as_coeff_Mul())
        if not number.is_Rational:
            number, rest = S.One, term
        factors = [] if rest == 1 else _args(Mul, rest)
        above, below, vectors = [], [], []
        for factor in factors:
            base, exponent = _power_of(factor)
            if base in self.atoms and exponent.is_positive:
                vectors.append(factor)
            elif exponent.is_Rational and exponent.is_negative:
                below.append(base**-exponent)
            else:
                above.append(factor)
        # A factor that is a sum needs no parentheses when it stands alone.
        alone = len(above) == 1 and not vectors and not below and abs(number) == 1
        if alone and above[0].is_Add and number > 0:
            return False, self.sum(above[0])
        above.sort(key=self.factor_rank)
        below.sort(key=self.factor_rank)
        vectors.sort(key=lambda factor: (self.is_vector(factor), self.factor_rank(factor)))
        if below and len(vectors) == 1 and self.is_vector(vectors[0]):
            written = [*map(self.factor, above), self.factor(vectors.pop())]  # x/r, not 1/r x
        else:
            written = [self.factor(factor) for factor in above]
        numerator, denominator = abs(int(number.p)), int(number.q)
        if long := long_number(numerator, denominator):
            decimal, denominator = long
            numerator, written = 1, [decimal.write(self.style), *written]
        return bool(number < 0), self.style.product(
            numerator,
            written,
            denominator,
            [self.factor(factor) for factor in below],
            [self.vector_factor(factor, among=len(vectors)) for factor in vectors],
        )

    def is_vector(self, factor: Expr) -> bool:
        """Whether this is a vector; one made by a cross product does not count, as it binds its factors loosely."""
        return isinstance(self.atoms.get(cast("Symbol", factor)), (Image, Itself))

    def factor_rank(self, factor: Expr) -> tuple[Any, ...]:
        base, _ = _power_of(factor)
        place = self.place(base)
        named = (0, (bool(split_name(str(factor))[1]), str(factor)))
        return named if place is None else (1, place[1])

    def factor(self, expression: Expr) -> str:
        """A factor of a product: in parentheses if it is a sum."""
        base, exponent = _power_of(expression)
        if isinstance(self.atoms.get(base), Square) and exponent.is_Rational:
            return self.vector_factor(expression, among=1)
        if exponent == 1:
            text = self.atomic(base)
            return self.style.parentheses(text) if base.is_Add or base.is_Mul else text
        if exponent.is_Rational and exponent.q == 2 and exponent.is_positive:
            root = self.style.root(self.sum(base))
            return root if exponent.p == 1 else self.style.power(root, str(exponent.p))
        text = self.atomic(base)
        if not (base.is_Symbol or (base.is_Integer and base >= 0) or base.is_Function) or base in self.atoms:
            text = self.style.parentheses(text)
        return self.style.power(text, self.sum(exponent))

    def vector_factor(self, expression: Expr, *, among: int) -> str:
        base, exponent = _power_of(expression)
        atom = self.atoms[cast("Symbol", base)]
        if isinstance(atom, Square):
            length = f"|{write_vector(atom.u, self.style)}|"
            return length if 2 * exponent == 1 else self.style.power(length, self.sum(2 * exponent))
        text = write_atom(atom, self.style)
        if exponent == 1:
            return self.style.parentheses(text) if among > 1 and not self.is_vector(expression) else text
        return self.style.power(self.style.parentheses(text), self.sum(exponent))

    def atomic(self, expression: Expr) -> str:
        """What is not a product or a power: a symbol, a number, a function, a sum."""
        if expression.is_Symbol:
            symbol = cast("Symbol", expression)
            if symbol in self.atoms:
                return write_atom(self.atoms[symbol], self.style)
            name = str(symbol)
            return self.style.component(name, *(self.coordinates.get(name) or split_name(name)))
        if getattr(expression, "is_trace", False):
            return write_trace(cast("Any", expression), self.style)
        if expression.is_Function:
            arguments = ", ".join(self.sum(cast("Any", argument)) for argument in expression.args)
            return self.style.function(str(expression.func), arguments)
        if expression.is_NumberSymbol:
            return self.style.component(str(expression), str(expression), "")
        composed = expression.is_Add or expression.is_Mul or expression.is_Pow or expression.is_Rational
        return self.sum(expression) if composed else self.style.other(expression)


_NOT_A_FIELD = 10_000


def _power_of(expression: Expr) -> tuple[Any, Any]:
    """Base and exponent; exp(x) counts as a function, not as a power."""
    from sympy import S

    return expression.as_base_exp() if expression.is_Pow else (expression, S.One)


def _args(kind: Any, expression: Expr) -> list[Any]:
    return list(kind.make_args(expression))
