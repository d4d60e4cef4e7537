"""The tops with which the page tells its story: parameters and starts as exact texts."""

from __future__ import annotations

from typing import Any

Texts = tuple[str, ...]

_NONE: Texts = ("0", "0", "0")


def _preset(
    key: str,
    title: str,
    kind: str,
    story: str,
    *,
    inertia: Texts,
    start: Texts,
    section: tuple[str, str, str],
    a: Texts = _NONE,
    b: Texts = _NONE,
    epsilon: str = "0",
) -> dict[str, Any]:
    surface, across, up = section
    return {
        "key": key,
        "title": title,
        "kind": kind,
        "story": story,
        "parameters": [*inertia, *a, *b, epsilon],
        "start": list(start),
        "surface": surface,
        "axes": [across, up],
    }


def presets() -> list[dict[str, Any]]:
    """In the order of the story; `kind` is what is proved or computed of the top, `section` surface and axes."""
    kovalevskaya: dict[str, Any] = {"inertia": ("2", "2", "1"), "a": ("-1", "0", "0")}
    start = ("2/5", "1/5", "-2/5", "4/5", "3/5", "0", "0", "0", "1")
    return [
        _preset(
            "lagrange",
            "Lagrange top",
            "integrable",
            "The axis nods and precesses, but up stays up. Every orbit lies on a torus.",
            inertia=("1", "1", "3/5"),
            a=("0", "0", "1"),
            start=("7/20", "1/10", "19/10", "7/25", "0", "24/25", "24/25", "0", "-7/25"),
            section=("l1", "l2", "alpha1"),
        ),
        _preset(
            "twisted-lagrange",
            "Twisted Lagrange",
            "integrable",
            "The twist turns up into a vector that moves. The symmetry of the body keeps the motion regular.",
            inertia=("1", "1", "3/5"),
            a=("0", "0", "1"),
            epsilon="1",
            start=("7/20", "1/10", "19/10", "7/25", "0", "24/25", "24/25", "0", "-7/25"),
            section=("l1", "l2", "alpha1"),
        ),
        _preset(
            "kovalevskaya",
            "Kovalevskaya top",
            "integrable",
            "No symmetry explains the hidden integral K that keeps this motion regular.",
            **kovalevskaya,
            start=start,
            section=("l3", "l1", "l2"),
        ),
        _preset(
            "twisted-kovalevskaya",
            "Twisted Kovalevskaya",
            "chaotic",
            "Twist it and the hidden integral is gone. Points scatter, and the shadow top parts company.",
            **kovalevskaya,
            epsilon="1",
            start=start,
            section=("l3", "l1", "l2"),
        ),
        _preset(
            "charged",
            "Charged heavy top",
            "chaotic",
            "Two fixed fields pull at two centres. Only energy and Casimirs stay, and the orbit is chaotic.",
            inertia=("1", "3/2", "2"),
            a=("1", "0", "1/2"),
            b=("0", "1", "0"),
            start=("1/2", "1/5", "4/5", "4/5", "3/5", "0", "0", "0", "1"),
            section=("l3", "l1", "l2"),
        ),
        _preset(
            "sticky",
            "Sticky orbit",
            "chaotic, late",
            "For a thousand time units it keeps beside a torus and all indicators call it regular. Then it leaves.",
            inertia=("2", "2", "6/5"),
            a=("-1", "0", "0"),
            start=(
                "-0.19626561904764797",
                "-0.8860343484915977",
                "0.4200273087227943",
                "-0.5834073300263803",
                "0.8110261654715097",
                "0.04327177130727689",
                "-0.3226687386922418",
                "-0.9384119204156346",
                "-0.12356355729987213",
            ),
            section=("l3", "l1", "l2"),
        ),
        _preset(
            "collinear",
            "Collinear start",
            "chaotic",
            "Both fields start on one line, where Euler angles do not exist. The twist parts them at once.",
            **kovalevskaya,
            epsilon="1",
            start=("2/5", "1/5", "-2/5", "0", "0", "1/2", "0", "0", "1"),
            section=("l3", "l1", "l2"),
        ),
        _preset(
            "two-field",
            "Two-field Kovalevskaya",
            "integrable",
            "Two fields in the equatorial plane, two more integrals: three degrees of freedom, still regular.",
            **kovalevskaya,
            b=("0", "-1", "0"),
            start=start,
            section=("l3", "l1", "l2"),
        ),
    ]
