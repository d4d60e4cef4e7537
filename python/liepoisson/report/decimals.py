"""Long rational numbers as decimals: 1e-320 is not written with 320 zeros."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

LONG_NUMBER = 12
"""Characters of a number that is still written as a fraction, or with all its zeros."""


@dataclass(frozen=True)
class Decimal:
    """A positive or negative number, exactly: sign, digits and a power of ten.

    Attributes:
        mantissa: Its digits, with a sign and a point where there is one.
        exponent: The power of ten, as text; empty if it is left out.
    """

    mantissa: str
    exponent: str = ""

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
