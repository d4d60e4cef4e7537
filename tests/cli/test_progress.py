"""Progress where there is no terminal: a line from time to time, none of short runs, none with --quiet."""

import pytest

from liepoisson.cli import progress


@pytest.fixture
def clock(monkeypatch):
    """A clock that is set by hand."""
    now = [0.0]
    monkeypatch.setattr(progress.clock, "monotonic", lambda: now[0])
    return now


def test_long_runs_say_how_far_they_are(clock, capsys):
    with progress.progress_bar() as listen:
        for clock[0] in range(1, 200):
            listen("integrating", clock[0], 400.0)
    assert capsys.readouterr().err.splitlines() == [
        "liepoisson: integrating, 2% after 10 s, about 6 min 30 s left",
        "liepoisson: integrating, 18% after 1 min 10 s, about 5 min 30 s left",
        "liepoisson: integrating, 32% after 2 min 10 s, about 4 min 30 s left",
        "liepoisson: integrating, 48% after 3 min 10 s, about 3 min 30 s left",
    ]


def test_short_and_quiet_runs_say_nothing(clock, capsys):
    with progress.progress_bar() as listen:
        for clock[0] in (0.0, 5.0, 9.9):
            listen("integrating", 1.0, 2.0)
    with progress.progress_bar(quiet=True) as listen:
        assert listen is None
    assert capsys.readouterr() == ("", "")
