"""Importing is light: heavy libraries load when they are used."""

import ast
import pkgutil
import subprocess
import sys
import types
from importlib import import_module
from pathlib import Path

import pytest

import liepoisson as lp


def loaded(program):
    heavy = ("sympy", "xarray", "matplotlib", "typer", "rich", "jinja2", "h5py", "pandas", "scipy")
    heavy += ("zarr", "dask", "distributed")
    code = f"import sys\n{program}\nprint(*[name for name in {heavy!r} if name in sys.modules])"
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout.split()


@pytest.mark.thorough
def test_an_exponent_needs_numpy_only():
    program = """
import liepoisson as lp
top = lp.Top.twisted_kovalevskaya()
growth = lp.finite_time_exponents(top, lp.sample_states(top, 2, seed=1), t_end=1)
orbit = lp.integrate(top, growth.end_state, times=[0, 1], dense=True).at(0.5)
"""
    assert loaded(program) == []


def test_a_first_orbit_loads_no_exact_linear_algebra():
    program = """
import sys, liepoisson as lp
lp.integrate(lp.Top.kovalevskaya(), [1, 0, 1, 0, 0, 1, 0, 0, 0], t_end=1)
print(*{"random", "liepoisson.algebra.coefficients", "liepoisson.algebra.linear_algebra"} & {*sys.modules})
"""
    found = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert found.stdout.split() == []


VALUES = {"epsilon": "1/2", "I": [2, 3, "5/2"], "a": [1, "1/3", "1/5"], "b": ["1/7", 2, "1/4"]}
"""Of the parameters of those entries of the catalog that have none."""


@pytest.mark.thorough
def test_orbits_of_typed_systems_need_no_sympy():
    """Of all entries of the catalog, and of systems with names, surds and sines in their brackets and parameters.

    Only tensors that are given by formulas are read by SymPy.
    """
    program = f"""
import liepoisson as lp
def entry(name):
    symbols = [text.partition("[")[0] for text in lp.catalog.entry(name).symbols]
    return lp.catalog.system(name, {{key: {VALUES!r}[key] for key in symbols}} or None)
tensors = ("lotka-volterra-3", "lotka-volterra-4", "sklyanin", "volterra-lattice-5")
systems = {{name: entry(name) for name in lp.catalog.names() if name not in tensors}}
typed = "p_q^2/(2*m) - cos(q) + k*sqrt(1 + q^2) + exp(-q^2)/(1 + exp(-q^2))"
systems["typed"] = lp.System(lp.canonical(names=["q"]), typed, parameters={{"m": "3/sqrt(2)", "k": "cos(pi/5)"}})
constant = (lp.so(3) @ lp.trivial()).with_constant({{("l1", "l2"): "k/3", ("l2", "l3"): "sqrt(2)/pi"}})
systems["a constant part"] = lp.System(constant, "dot(l, l)^2/4 + l1*l3", parameters={{"k": 2}})
cubic = lp.so(3) @ lp.extensions.binary_cubic("a", 0, "2*b", 1)
values = {{"a": 1, "b": "3/2"}}
systems["an extension"] = lp.System(cubic, "sin(l1) + dot(alpha, alpha) + beta2^2", parameters=values)
for name, system in systems.items():
    starts = [0.3 + 0.07 * k for k in range(len(system.component_names))]
    assert lp.integrate(system, starts, t_end=1).outcome[0] == "finished", name
    if "sympy" in sys.modules:
        print(name)
        break
"""
    assert loaded(program) == []


def test_a_section_of_a_typed_system_needs_no_sympy():
    program = """
import liepoisson as lp
pendulum = lp.System(lp.canonical(names=["q"]), "p_q^2/2 - k*cos(q)", parameters={"k": "sqrt(2)"})
assert lp.section(pendulum, [[0.3, 0.1]], surface="sin(q)", t_end=30).n_crossings is None
"""
    assert loaded(program) == []


def test_splitting_of_a_polynomial_needs_no_sympy():
    program = """
import liepoisson as lp
system = lp.System(lp.so(3) @ lp.trivial(), "l1^2 + l2^2/2 + l1*l2*l3^2", name="quartic")
lp.integrate(system, [0.3, 0.1, 0.2], t_end=1, method=lp.Splitting(step=0.01))
"""
    assert loaded(program) == []


CALLS = """
from liepoisson.cli.main import COMMANDS, main

CALLED = {called}
HEAVY = ("sympy", "xarray", "pandas", "scipy", "matplotlib", "matplotlib.pyplot", "rich", "h5netcdf")
for arguments in {calls}:
    sys.argv = ["liepoisson", *arguments]
    try:
        main()
    except SystemExit as end:
        assert not end.code, (arguments, end.code)
    called = {{COMMANDS[name] for name in CALLED}}
    others = [m for m in {{*COMMANDS.values()}} - called if f"liepoisson.cli.{{m}}" in sys.modules]
    print("LOADED", *others, *(name for name in HEAVY if name in sys.modules))
sys.exit()
"""


def loaded_by(calls, folder):
    """The heavy modules, and the commands that were not called, that are there after each command of one process."""
    program = "import sys\n" + CALLS.format(calls=calls, called={call[0] for call in calls})
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("LOADED")]


def test_commands_on_rational_systems_import_no_computer_algebra(tmp_path):
    """Polynomials with rational coefficients: equations, Casimirs, leaves and surfaces are derived without SymPy."""
    few, short = ("--starts", "2", "--crossings", "5"), ("--t-end", "5")
    numbers = [
        *(("orbit", name, *short) for name in ("kovalevskaya", "henon-heiles", "clebsch", "rattleback")),
        *(("orbit", name, *short) for name in ("twisted-kovalevskaya", "two-field-kovalevskaya", "leibniz-top-4")),
        *(("section", name, *few) for name in ("kovalevskaya", "twisted-kovalevskaya")),
        ("lyapunov", "charged-twisted-lagrange", "--starts", "2", *short, "--set", "epsilon=1/3"),
        ("section", "henon-heiles", *few, "--energy", "0.1", "--surface", "x"),
        ("lyapunov", "lagrange", "--starts", "2", *short),
        ("orbit", "heavy-top", *short, "--set", "I=3,2,1", "--leaf", "C1=1/2", "--energy", "2", "--out", "a.csv"),
    ]
    figures = [
        ("orbit", "kovalevskaya", *short, "--plot"),
        ("section", "kovalevskaya", *few, "--figure", "a.svg"),
        ("lyapunov", "lagrange", "--starts", "2", *short, "--figure", "b.png"),
    ]
    found = loaded_by([*numbers, *figures], tmp_path)
    assert found == [[]] * len(numbers) + [["matplotlib"]] * len(figures)
    assert {path.name for path in tmp_path.iterdir()} == {"a.csv", "kovalevskaya-orbit.png", "a.svg", "b.png"}


def test_an_orbit_of_a_typed_system_imports_no_computer_algebra(tmp_path):
    """Energy, Casimirs and the integrals of the catalog are evaluated as the core reads them."""
    names = ("toda", "double-pendulum", "goryachev", "gyrostat", "kepler-on-the-sphere", "spring-pendulum")
    assert loaded_by([("orbit", name, "--t-end", "1") for name in names], tmp_path) == [[]] * len(names)


@pytest.mark.parametrize("system", ["kovalevskaya", "zeitlin-5"])
def test_a_description_loads_no_numpy(system):
    """It has no arrays; its matrices are small enough that Python is done before NumPy is loaded."""
    program = f"""
sys.argv = ["liepoisson", "inspect", "{system}"]
from liepoisson.cli.main import main
try:
    main()
except SystemExit as end:
    assert not end.code
print("LOADED", *(name for name in ("numpy", "matplotlib") if name in sys.modules))
sys.exit()
"""
    done = subprocess.run([sys.executable, "-c", "import sys" + program], capture_output=True, text=True, check=True)
    assert "proved: J grad C = 0 for each" in done.stdout
    assert done.stdout.splitlines()[-1] == "LOADED"


CHAPTERS = [name for name in lp.__all__ if isinstance(getattr(lp, name), types.ModuleType)]
"""All but `catalog`, `errors` and `plot` are made of a stub alone."""


def stub_of(module):
    """Module by public name, as the stub of a module has them, which is what type checkers read."""
    tree = ast.parse(Path(module.__file__).with_suffix(".pyi").read_text(encoding="utf-8"))
    imports = [node for node in tree.body if isinstance(node, ast.ImportFrom)]
    assert len(tree.body) == len(imports)
    assert all(alias.asname == alias.name for node in imports for alias in node.names)
    return {alias.name: node.module for node in imports for alias in node.names}


@pytest.mark.parametrize("chapter", [None, *(name for name in CHAPTERS if name not in {"catalog", "errors", "plot"})])
def test_every_public_name_is_the_object_that_its_stub_promises(chapter):
    module = lp if chapter is None else getattr(lp, chapter)
    homes = stub_of(module)
    assert dir(module) == sorted(homes) == module.__all__
    for name, home in homes.items():
        if home == "liepoisson":
            assert getattr(module, name) is import_module(f"liepoisson.{name}")
        else:
            assert getattr(module, name) is vars(import_module(home))[name], name
            assert name == "__version__" or getattr(module, name).__name__ == name


def test_no_module_hides_a_public_name():
    """Importing `liepoisson.leaf.leaf` sets `leaf` in the chapter; only `plot` imports its modules at once."""
    for module in (lp, *(getattr(lp, name) for name in CHAPTERS if name != "plot")):
        inside = {info.name for info in pkgutil.iter_modules(getattr(module, "__path__", ()))}
        assert inside & set(module.__all__) <= set(CHAPTERS), module.__name__


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'bogus'"):
        lp.bogus  # noqa: B018
    with pytest.raises(AttributeError, match="did you mean integrate"):
        lp.integrat  # noqa: B018
    with pytest.raises(AttributeError, match=r"it is liepoisson\.results\.Orbit"):
        lp.Orbit  # noqa: B018
