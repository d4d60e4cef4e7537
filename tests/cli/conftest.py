"""Commands run in this process, as a person would type them."""

import sys

import pytest

from liepoisson.cli.main import main


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
