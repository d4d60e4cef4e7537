"""`liepoisson catalog`: the named systems, with the short form of their sources."""

import pytest

from liepoisson import catalog
from liepoisson.cli.literature import short_source


def test_every_system_has_its_line(command):
    code, out, err = command("catalog")
    assert (code, err) == (0, "")
    assert [line.split()[0] for line in out.splitlines()] == list(catalog.names())
    assert "Thiffeault and Morrison (2001)" in next(line for line in out.splitlines() if line.startswith("twisted-top"))


@pytest.mark.parametrize(
    ("source", "short"),
    [
        ("L. Euler, Theoria motus corporum (1765)", "Euler (1765)"),
        ("J.-L. Thiffeault and P. J. Morrison, The twisted top, Physics (2001) 335", "Thiffeault and Morrison (2001)"),
        (
            "A. I. Bobenko, A. G. Reyman and M. A. Semenov-Tian-Shansky, Title (1989); O. I. Other (1984)",
            "Bobenko, Reyman and Semenov-Tian-Shansky (1989)",
        ),
        ("D. N. Goryachev (1900) and S. A. Chaplygin (1901), after M. Audin", "Goryachev and Chaplygin (1900)"),
        ("my own notes", "my own notes"),
        ("x" * 80, "x" * 57 + "..."),
    ],
)
def test_short_form_of_a_source(source, short):
    assert short_source(source) == short
