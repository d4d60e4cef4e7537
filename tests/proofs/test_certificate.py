"""Certificates are read strictly: what is not exact, finite or complete is refused."""

import json

import pytest

from liepoisson.errors import CertificateError, DamagedFileError, MissingFileError
from liepoisson.proofs.certificate import load_covering_certificate
from liepoisson.proofs.theorem import compare_equations

REFUSED = {
    "no sets": lambda d: d.update(sets=[]),
    "no edges key": lambda d: d.pop("edges"),
    "a decimal": lambda d: d["sets"][0]["center"].__setitem__(0, "0.5"),
    "a number": lambda d: d["sets"][0]["center"].__setitem__(0, 0.5),
    "nan": lambda d: d["sets"][0]["center"].__setitem__(0, "nan"),
    "infinity": lambda d: d["sets"][0]["frame"][0].__setitem__(0, "inf"),
    "too large": lambda d: d["sets"][0]["frame"][0].__setitem__(0, "0x1p+5000"),
    "more digits than a double": lambda d: d["sets"][0]["center"].__setitem__(0, "0x1.00000000000008p+0"),
    "eight components": lambda d: d["sets"][0]["center"].pop(),
    "one name twice": lambda d: d["sets"][1].update(name="p_a"),
    "an unknown set": lambda d: d["edges"][0].update(to="p_c"),
    "a time of zero": lambda d: d["edges"][0].update(time="0x0p+0"),
    "a negative time": lambda d: d["edges"][0].update(time="-0x1p+0"),
    "a flag that is a number": lambda d: d["edges"][0].update(symmetry=1),
    "a sign of two": lambda d: d["symmetry"].__setitem__(0, 2),
    "a sign that is true": lambda d: d["symmetry"].__setitem__(0, True),
    "a level that is a number": lambda d: d["level"].update(H=0.5),
    "a level divided by zero": lambda d: d["level"].update(H="1/0"),
    "a time with a long exponent": lambda d: d["edges"][0].update(time="0x0p999999999999"),
    "a level with a long exponent": lambda d: d["level"].update(H="1e999999999"),
    "a radius that no interval has": lambda d: d.update(level_radius="1/1" + "0" * 40),
    "a level with many digits": lambda d: d["level"].update(H="0." + "3" * 45),
    "a radius with a long exponent": lambda d: d.update(level_radius="1e-\uff19\uff19\uff19999999"),
    "no system": lambda d: d.pop("system"),
    "an unknown entry": lambda d: d.update(levelradius="1/2"),
    "an unknown entry of the system": lambda d: d["system"].update(parameters={}),
    "an unknown entry of a set": lambda d: d["sets"][0].update(centre=[]),
    "an unknown entry of an edge": lambda d: d["edges"][0].update(symetry=True),
}


def test_equations_that_lack_one_are_refused(shipped, twisted):
    equations = shipped["system"]["equations"]
    lines = [f"d{name}/dt = {rate}" for name, rate in equations.items()]
    for name in twisted.names:
        fewer = {k: v for k, v in equations.items() if k != name}
        with pytest.raises(CertificateError, match=f"lack the rate of {name}"):
            compare_equations(fewer, twisted)
        with pytest.raises(CertificateError, match=f"lack the rate of {name}"):
            compare_equations([line for line in lines if not line.startswith(f"d{name}/")], twisted)
    with pytest.raises(CertificateError, match=r"wanted an equation for each of l1, .*; got 8"):
        compare_equations(list(equations.values())[:-1], twisted)
    with pytest.raises(CertificateError, match="lack the rate of l1"):
        compare_equations([lines[1], *lines[1:]], twisted)
    assert "not compared" in compare_equations(["l' = l x omega", "alpha' = alpha x omega"], twisted)


@pytest.mark.parametrize("change", REFUSED.values(), ids=REFUSED)
def test_another_form_is_refused(altered, tmp_path, change):
    change(altered)
    path = tmp_path / "proof.json"
    path.write_text(json.dumps(altered))
    with pytest.raises(DamagedFileError):
        load_covering_certificate(path)


def test_what_is_no_json_is_refused(tmp_path):
    path = tmp_path / "proof.json"
    for text in ("", "{", "[]", '{"level": {}, "level": {}}', "[" * 100_000):
        path.write_text(text)
        with pytest.raises(DamagedFileError):
            load_covering_certificate(path)
    with pytest.raises(MissingFileError):
        load_covering_certificate(tmp_path / "none.json")


def test_equations_are_compared_in_any_order_and_form(shipped, twisted):
    equations = shipped["system"]["equations"]
    assert "are those of the system" in compare_equations(equations, twisted)
    lines = [f"d{name}/dt = {rate}" for name, rate in reversed(equations.items())]
    assert "are those of the system" in compare_equations(lines, twisted)
    assert "are those of the system" in compare_equations("\n".join(lines), twisted)
    assert "are those of the system" in compare_equations(list(equations.values()), twisted)
    assert "not compared" in compare_equations("l' = l x omega + alpha x a", twisted)
    assert "not compared" in compare_equations(17, twisted)


@pytest.mark.parametrize("name", ["l1", "alpha2", "beta3"])
def test_equations_of_another_system_are_refused(altered, twisted, name):
    equations = altered["system"]["equations"]
    equations[name] = f"-({equations[name]})"
    with pytest.raises(CertificateError, match=f"rate of {name}"):
        compare_equations(equations, twisted)
    with pytest.raises(CertificateError, match="another system"):
        compare_equations([f"{k}' = {v}" for k, v in equations.items()], twisted)
