"""A study of the twisted top so small that tests can run it."""

from liepoisson.studies.twisted_top import integration, runs
from liepoisson.studies.twisted_top.integration import RunStore, Tracker, complete
from liepoisson.studies.twisted_top.runs import Settings, plan

SMALL = Settings(members=50, end_time=60.0)
# Long enough for every claim that is judged by numbers.
SHORT = Settings(members=50, end_time=200.0)


def one_run(settings, name):
    return next(run for run in plan(settings) if run.name == name)


def integrate(out, settings, name, progress=None):
    store = RunStore(out, one_run(settings, name))
    growth, _ = complete(store, None, Tracker([store], progress))
    return growth


def stored_piece(tmp_path, monkeypatch):
    """A store with one of two pieces done."""
    monkeypatch.setattr(runs, "PIECE_SIZE", 25)
    store = RunStore(tmp_path, one_run(SMALL, "twisted-unit-vectors"))
    integration.integrate_piece(store, 0, 25, 1, Tracker([store], None))
    return store
