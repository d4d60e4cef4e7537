"""The commands take every method of the package, with its options."""

import dataclasses
import inspect
import typing

import pytest

from liepoisson.cli.chaos import lyapunov
from liepoisson.cli.options import flat
from liepoisson.cli.orbit import orbit
from liepoisson.cli.runs import DEFAULT_STEP, named_method
from liepoisson.cli.section import section
from liepoisson.errors import ParameterError, UnknownNameError
from liepoisson.numeric.method.method import precisions
from liepoisson.numeric.methods import CHOICES


def help_of(command, option):
    """What `--help` says about an option."""
    return typing.get_type_hints(command, include_extras=True)[option].__metadata__[0].help


@pytest.mark.parametrize("name", CHOICES)
def test_a_method_is_made_by_name_with_any_of_its_options(name):
    kind = CHOICES[name]
    assert type(named_method(name)) is kind
    values = {"tol": 3e-5, "step": 0.3, "order": 6, "precision": precisions(kind)[-1]}
    for option, value in values.items():
        if option in {field.name for field in dataclasses.fields(kind)}:
            assert getattr(named_method(name, **{option: value}), option) == value
        elif value != "double":
            with pytest.raises(ParameterError, match=f"--{option} is not an option of {name}"):
                named_method(name, **{option: value})


@pytest.mark.parametrize("command", [flat(lyapunov), flat(orbit), flat(section)])
def test_the_help_names_every_method_and_who_takes_an_option(command):
    options = inspect.signature(command).parameters
    assert all(name in help_of(command, "method") for name in CHOICES)
    for option in {"tol", "precision"} & options.keys():
        for name, kind in CHOICES.items():
            takes = option in {field.name for field in dataclasses.fields(kind)}
            assert (name in help_of(command, option)) is takes, (name, option)


def test_a_step_that_was_not_given_is_a_tenth_of_a_natural_time():
    assert named_method("gauss", unit=0.33).step == pytest.approx(DEFAULT_STEP * 0.33)
    assert named_method("gauss", unit=0.33, step=0.1).step == 0.1
    assert named_method("runge-kutta", unit=0.33).step is None


def test_a_name_that_no_method_has_is_refused():
    with pytest.raises(UnknownNameError, match=r"--method must be one of taylor, .*; got 'euler'"):
        named_method("euler")
