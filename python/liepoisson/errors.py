"""Every way in which liepoisson refuses a call.

A message says what was wanted, what came, and what to try.  A trajectory that fails is not an error but an
*outcome* in the result; see `liepoisson.numeric`.
"""

from __future__ import annotations

from collections.abc import Iterable

__all__ = [
    "BracketError",
    "CertificateError",
    "ChartError",
    "CochainError",
    "CocycleError",
    "CompatibilityError",
    "ConstraintError",
    "ContractionError",
    "CoreError",
    "DamagedFileError",
    "EnclosureError",
    "ExpressionError",
    "InertiaWarning",
    "JacobiError",
    "LaxPairError",
    "LeafError",
    "LiePoissonError",
    "MemoryLimitError",
    "MissingFileError",
    "MissingPackageError",
    "MixingWarning",
    "ObstructionError",
    "OrbitError",
    "OutputError",
    "ParameterError",
    "ShapeError",
    "SurfaceWarning",
    "SystemFileError",
    "ThreadLimitError",
    "TimeLimitError",
    "UnknownNameError",
    "UnsupportedFieldError",
]


class LiePoissonError(Exception):
    """Base of all errors raised on purpose by liepoisson."""


class ShapeError(LiePoissonError, ValueError):
    """An array does not have the shape its docstring asks for."""


class ParameterError(LiePoissonError, ValueError):
    """A parameter has a value outside its domain (not finite, not positive, of the wrong sign, ...)."""


class ExpressionError(ParameterError):
    """A formula that is not in our grammar, or has no meaning here.

    Attributes:
        position: Offset of the offending character in `text`, counted from 0.
        line: Its line, counted from 1.
        column: Its column, counted from 1.
        text: The whole formula.
    """

    def __init__(self, message: str, text: str, position: int) -> None:
        self.message = message
        self.text = text
        self.position = min(position, len(text))
        before = text[: self.position]
        self.line = before.count("\n") + 1
        self.column = self.position - before.rfind("\n")
        super().__init__(f"{message} (line {self.line}, column {self.column}).{self._caret()}")

    def __reduce__(self) -> tuple[type[ExpressionError], tuple[str, str, int]]:
        return type(self), (self.message, self.text, self.position)

    def within_formula(self) -> str:
        """The message for a formula in a file or an option: lines and columns are those of the formula, and say so."""
        line = f"line {self.line}, " if "\n" in self.text else ""
        return f"{self.message} ({line}column {self.column} of the formula).{self._caret()}"

    def _caret(self) -> str:
        """The line of the formula with a caret below the place, abridged to what surrounds it."""
        if not self.text.strip():
            return ""
        line = self.text.split("\n")[self.line - 1]
        start = max(0, self.column - 41)
        shown = "".join(character if character.isprintable() else " " for character in line[start : start + 80])
        left, right = "..." if start else "", "..." if len(line) > start + 80 else ""
        return f"\n    {left}{shown}{right}\n    {' ' * (len(left) + self.column - 1 - start)}^"


class SystemFileError(LiePoissonError, ValueError):
    """A system file that cannot be read, or does not describe a system; the message names the key and the line."""


class UnknownNameError(LiePoissonError, LookupError):
    """A name (of an ensemble, a study, a system, a claim) that is not in the list of known names."""


class BracketError(LiePoissonError, ValueError):
    """Structure constants, an extension tensor or formulas that do not define a Poisson bracket, or no such one."""


class JacobiError(BracketError):
    """Formulas of a Poisson tensor that does not obey the Jacobi identity.

    Attributes:
        triple: Names of the three coordinates at which it fails.
        residual: The cyclic sum of {{x, y}, z} for them, as text; it should be 0.
        reason: What the cyclic sum is, in words, where the entries are derived from something else; else "".
    """

    def __init__(self, triple: tuple[str, ...], residual: str, reason: str = "") -> None:
        self.triple, self.residual, self.reason = triple, residual, reason
        first, second, third = triple
        super().__init__(
            f"the entries of a Poisson tensor must obey the Jacobi identity; for ({', '.join(triple)}) the cyclic sum "
            f"of {{{{{first}, {second}}}, {third}}} is {residual:.200} instead of 0. {reason or 'Correct its entries'}."
        )

    def __reduce__(self) -> tuple[type[JacobiError], tuple[tuple[str, ...], str, str]]:
        return type(self), (self.triple, self.residual, self.reason)


class ConstraintError(BracketError):
    """Constraints that have no Dirac bracket: a combination of them is first class.

    Attributes:
        combination: A combination of the constraints whose brackets with all of them vanish where they do, as text; ""
            if none was computed.
        part: On which part of the set where they vanish, in words; "" if on all of it.
        is_proved: Whether that is proved, or seen at some states only.
    """

    def __init__(self, combination: str, part: str, *, is_proved: bool = True) -> None:
        self.combination, self.part, self.is_proved = combination, part, is_proved
        place = f" {part}" if part else ""
        what = (
            f"{combination:.300} is first class, its brackets with all of them vanish{place or ' where they do'}"
            if combination
            else f"the determinant of their brackets vanishes{place}"
        )
        super().__init__(
            f"a Dirac bracket needs constraints of second class, det {{phi_a, phi_b}} != 0; {what}. Add a function "
            "whose bracket with it does not vanish, such as its time derivative or a gauge condition; leave it out if "
            "it is a Casimir."
        )

    def __reduce__(self) -> tuple[type[ConstraintError], tuple[str, str], dict[str, bool]]:
        return type(self), (self.combination, self.part), {"is_proved": self.is_proved}


class CocycleError(BracketError):
    """A cochain that is no 2-cocycle: the constant part of a bracket, or a twist of a commutative algebra.

    The Jacobi identity fails then, or associativity to first order.

    Attributes:
        triple: Names of the three coordinates, or basis elements, at which it fails.
        residual: What should be 0 for them, as text: the cyclic sum of {{x, y}, z}, or the differential.
        of_algebra: Whether it is a symmetric cochain of a commutative algebra.
    """

    def __init__(self, triple: tuple[str, ...], residual: str, *, of_algebra: bool = False) -> None:
        self.triple, self.residual, self.of_algebra = triple, residual, of_algebra
        place = f"({', '.join(triple)})"
        super().__init__(
            f"a twist must be a 2-cocycle, a f(b, c) - f(a b, c) + f(a, b c) - f(a, b) c = 0; for {place} this is "
            f"{residual} instead of 0. Correct its products, or take a combination of the basis of cocycles."
            if of_algebra
            else f"the constant part must be a 2-cocycle of the Lie algebra, c([x, y], z) + cyclic = 0; for {place} "
            f"the cyclic sum of {{{{x, y}}, z}} is {residual} instead of 0. Correct its entries."
        )

    def __reduce__(self) -> tuple[type[CocycleError], tuple[tuple[str, ...], str], dict[str, object]]:
        return type(self), (self.triple, self.residual), {"of_algebra": self.of_algebra}


class ObstructionError(BracketError):
    """A cocycle of a commutative algebra that begins no deformation: higher terms do not mend its products.

    Attributes:
        order: The power of the parameter at which associativity fails.
        triple: Names of three basis elements at which it does.
        residual: What is left of (a b) c - a (b c) for them, modulo all further terms, as text; it should be 0.
        is_proved: Whether no choice of the lower terms helps; beyond order three that is not always decided.
    """

    def __init__(self, order: int, triple: tuple[str, ...], residual: str, *, is_proved: bool = True) -> None:
        self.order, self.triple, self.residual, self.is_proved = order, triple, residual, is_proved
        place = f"({', '.join(triple)})"
        doubt = "" if is_proved else " Other terms of lower order might do; whether they do is not decided."
        super().__init__(
            f"a deformation needs products that are associative at every order; at order {order} the residual for "
            f"{place} is {residual}, which no further term mends.{doubt} Take a twist at which the polynomials of "
            "`conditions` vanish."
        )

    def __reduce__(self) -> tuple[type[ObstructionError], tuple[int, tuple[str, ...], str], dict[str, object]]:
        return type(self), (self.order, self.triple, self.residual), {"is_proved": self.is_proved}


class ContractionError(BracketError):
    """A family of brackets that has no limit.

    Attributes:
        term: The product that grows without bound, in words.
        power: The power of the parameter with which it does, negative.
    """

    def __init__(self, term: str, power: int) -> None:
        self.term, self.power = term, power
        super().__init__(
            f"a contraction needs products that stay finite as the parameter goes to 0; got {term}. Change the "
            "weights: e_i e_j along e_k has the power w_i + w_j - w_k."
        )

    def __reduce__(self) -> tuple[type[ContractionError], tuple[str, int]]:
        return type(self), (self.term, self.power)


class CompatibilityError(BracketError):
    """Two Poisson brackets of which no pencil can be made, since their sum is none.

    Attributes:
        triple: Names of the three coordinates at which the Jacobi identity fails for the sum.
        residual: The cyclic sum of {{x, y}, z} for them, as text; it should be 0.
    """

    def __init__(self, triple: tuple[str, ...], residual: str) -> None:
        self.triple = triple
        self.residual = residual
        super().__init__(
            "wanted two compatible brackets, of which every linear combination obeys the Jacobi identity; for "
            f"({', '.join(triple)}) the cyclic sum of {{{{x, y}}, z}} is {residual} instead of 0. Take a bracket and "
            "the same frozen at a point, bracket.frozen(point), which are compatible."
        )

    def __reduce__(self) -> tuple[type[CompatibilityError], tuple[tuple[str, ...], str]]:
        return type(self), (self.triple, self.residual)


class UnsupportedFieldError(LiePoissonError):
    """The numeric core has no kernel for this vector field."""


class CochainError(BracketError):
    """A cochain of a Lie algebra that is no cocycle, df is not 0.

    Attributes:
        triple: Names of the basis elements at which it fails.
        residual: df at them, as text; it should be 0.
        cochain: What it is, for example "2-cochain of so(3)".
    """

    def __init__(self, triple: tuple[str, ...], residual: str, cochain: str) -> None:
        self.triple, self.residual, self.cochain = triple, residual, cochain
        super().__init__(
            f"the {cochain} must be a cocycle, df = 0; at ({', '.join(triple)}) df is {residual} instead of 0. "
            "Correct its entries.",
        )

    def __reduce__(self) -> tuple[type[CochainError], tuple[tuple[str, ...], str, str]]:
        return type(self), (self.triple, self.residual, self.cochain)


class MemoryLimitError(LiePoissonError, MemoryError):
    """A run that does not fit into memory, with its result; the message says how much was wanted."""


class ThreadLimitError(LiePoissonError, RuntimeError):
    """The system starts no thread for a run; the message says how many were wanted."""


class TimeLimitError(LiePoissonError, TimeoutError):
    """A limit of time that has passed before there was anything to return; the message says what was under way."""


class CoreError(LiePoissonError, RuntimeError):
    """A mistake in the compiled core, which stopped at it; the message says where."""


class LeafError(LiePoissonError, ValueError):
    """A state, an energy or values of Casimirs that belong to no point of the leaf that was asked for."""


class CertificateError(LiePoissonError, ValueError):
    """A certificate that proves nothing, or is about another system; the message names the first check that fails."""


class LaxPairError(LiePoissonError, ValueError):
    """Two matrices that are no Lax pair of a system, dL/dt = [L, M] fails.

    Attributes:
        entry: Row and column of the first entry at which it fails, counted from 1; for an element of a Lie algebra the
            component alone.
        residual: dL/dt - [L, M] at this entry, as text; it should be 0.
        n_failures: Number of entries at which it fails.
        reverses: Whether dL/dt = [M, L] holds: then -M in the place of M makes a pair.
    """

    def __init__(self, entry: tuple[int, ...], residual: str, n_failures: int = 1, *, reverses: bool = False) -> None:
        self.entry, self.residual, self.n_failures, self.reverses = entry, residual, n_failures, reverses
        others = n_failures - 1
        more = f" (and {others} other {'entry fails' if others == 1 else 'entries fail'})" if others else ""
        hint = (
            "dL/dt = [M, L] holds: give -M in the place of M"
            if reverses
            else "Correct this entry, or look for a pair with search_lax_pairs"
        )
        place = ", ".join(map(str, entry))
        super().__init__(
            f"a Lax pair must satisfy dL/dt = [L, M]; at entry ({place}) the residual dL/dt - [L, M] is {residual} "
            f"instead of 0{more}. {hint}."
        )

    def __reduce__(self) -> tuple[type[LaxPairError], tuple[object, ...], dict[str, object]]:
        return type(self), (self.entry, self.residual, self.n_failures), {"reverses": self.reverses}


class EnclosureError(LiePoissonError, ArithmeticError):
    """A rigorous enclosure that cannot be made: the set is too large, the time too long, a matrix may be singular."""


class ChartError(LiePoissonError, ValueError):
    """A state outside the domain of a canonical chart.

    Attributes:
        condition: The condition of the domain that fails, for example "sin(theta) != 0".
    """

    def __init__(self, message: str, condition: str) -> None:
        self.condition = condition
        super().__init__(message)

    def __reduce__(self) -> tuple[type[ChartError], tuple[str, str]]:
        return type(self), (str(self), self.condition)


class OrbitError(LiePoissonError, ValueError):
    """A periodic or homoclinic orbit that does not close, or a chain of sets along such orbits that was not found."""


class OutputError(LiePoissonError, OSError):
    """A result could not be written (path below a file, no permission, disk full)."""


class DamagedFileError(LiePoissonError, OSError):
    """A file is not what it should be: truncated, altered, or not written by liepoisson."""


class MissingPackageError(LiePoissonError, ImportError):
    """A package that only this part of liepoisson needs is not installed; the message says how to install it."""


class MissingFileError(LiePoissonError, FileNotFoundError):
    """There is no file of this name."""


class InertiaWarning(UserWarning):
    """Moments of inertia that no rigid body can have (triangle inequality); the equations do not need it."""


class SurfaceWarning(UserWarning):
    """A surface of section in which orbits lie, so that they cross it nowhere, or whose function cannot be followed."""


class MixingWarning(UserWarning):
    """Markov chains that remember their starts, so that their states are not distributed as they should be."""


def did_you_mean(name: object, known: Iterable[str]) -> str:
    """The question that begins a hint, "Did you mean l3? ", or nothing where no known name is near.

    What only looks like a known name, such as a symbol or a class, is to be given as a text.
    """
    from difflib import get_close_matches

    by_letters = {str(other).casefold(): str(other) for other in known}
    if not isinstance(name, str) and by_letters.get(str(name).casefold()) == str(name):
        return f'Write the text "{name}". '
    near = get_close_matches(str(name).casefold(), by_letters, n=1)
    return f"Did you mean {by_letters[near[0]]}? " if near else ""
