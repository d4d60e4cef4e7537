"""Commands run in this process, as a person would type them."""

import sys

import pytest

from liepoisson.cli.main import COMMANDS, application, main

LINES = {
    "reproduce": ("twisted-top",),
    "families": ("kovalevskaya", "--free", "a"),
    "deformations": ("twisted-kovalevskaya", "--parameter", "epsilon"),
    "prove": ("twisted-kovalevskaya", "--search"),
    "periodic": ("lagrange", "--period", "6"),
    "continue": ("lagrange", "--period", "6"),
    "melnikov": ("lagrange", "l1", "--start", "2,0,0,0,0,-1", "--origin", "alpha3=1", "--integral", "l3"),
    "fit": ("lagrange", "data.csv", "--unknown", "a3", "--start", "1,0,1,0,0,1"),
    "sweep": ("twist.toml",),
    "stationary": ("shaken.toml", "l3", "--edges", "-1:1:2", "--t-end", "10"),
    "passages": ("shaken.toml", "l3", "--t-end", "10"),
}
"""What a command must be given; where it is only a system, nothing stands here."""


@pytest.fixture
def lines():
    """Arguments with which each command runs, by its name."""
    return {name: LINES.get(name, ("lagrange",)) for name in COMMANDS}


@pytest.fixture(scope="session")
def parameters():
    """What each command takes, as Typer knows it."""
    from typer.main import get_command

    commands = get_command(application()).commands
    return {name: commands[name].params for name in COMMANDS}


@pytest.fixture
def command(monkeypatch, capsys):
    """Runs a command; its exit code, standard output and standard error."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["liepoisson", *map(str, arguments)])
        with pytest.raises(SystemExit) as stopped:
            main()
        printed = capsys.readouterr()
        return stopped.value.code or 0, printed.out, printed.err

    return run
