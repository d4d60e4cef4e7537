"""What can go wrong on a cluster, with real processes: the right numbers come out, the rest is reported."""

import os
import signal
import socket
import subprocess
import sys
import threading
import time
from contextlib import ExitStack, contextmanager

import numpy as np
import pytest

import liepoisson as lp
from liepoisson.sweeps.execute import SweepError
from liepoisson.sweeps.run import sweep
from liepoisson.sweeps.spec import Axis

pytestmark = [
    pytest.mark.slow,
    # Sockets of a connection that broke are closed by the garbage collector.
    pytest.mark.filterwarnings("ignore::ResourceWarning", "ignore::pytest.PytestUnraisableExceptionWarning"),
    pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning"),
    pytest.mark.filterwarnings("ignore::DeprecationWarning", "ignore::FutureWarning"),
]

SPEC = {
    "system": "twisted-top",
    "parameters": {"I": [2, 2, 1], "a": [-1, 0, 0], "b": [0, 0, 0]},
    "axes": (Axis.linear("epsilon", 0, 1, 12),),
    "n_starts": 64,
    "t_end": 16_000.0,
    "seed": 3,
    "points_per_piece": 1,
}


@pytest.fixture(scope="module")
def right():
    return sweep(**SPEC).value


def free_port():
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class Cluster:
    """A scheduler and workers, each a process that can be killed."""

    def __init__(self, stack):
        self.port = free_port()
        self.address = f"tcp://127.0.0.1:{self.port}"
        self._stack = stack

    def start(self, *command):
        process = subprocess.Popen([sys.executable, *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        self._stack.callback(stop, process)
        return process

    def scheduler(self):
        return self.start(
            "-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", str(self.port), "--no-dashboard",
            "--no-show",
        )  # fmt: skip

    def worker(self, version=None):
        options = ["--nthreads", "1", "--no-nanny", "--no-dashboard", self.address]
        if version is None:
            return self.start("-m", "distributed.cli.dask_worker", *options)
        program = f"import sys, liepoisson; liepoisson.__version__ = {version!r}; sys.argv[1:] = {options!r}; "
        return self.start("-c", program + "from distributed.cli.dask_worker import main; main()")


def stop(process):
    if process.poll() is None:
        process.kill()
    process.wait()


@contextmanager
def cluster():
    with ExitStack() as stack:
        yield Cluster(stack)


def after(pieces, action):
    """A listener that acts once, when so many pieces are done."""
    seen = []

    def listen(*_):
        seen.append(time.monotonic())
        if len(seen) == pieces:
            action()

    return listen


def test_processes_give_the_same_bits(right, tmp_path):
    result = sweep(**SPEC, processes=2, store=tmp_path / "a.zarr")
    np.testing.assert_array_equal(result.value, right)
    assert result.reports[0].workers == 2


def test_a_worker_is_killed(right):
    with cluster() as here:
        here.scheduler()
        first, _ = here.worker(), here.worker()
        result = sweep(**SPEC, scheduler=here.address, progress=after(3, lambda: os.kill(first.pid, signal.SIGKILL)))
    np.testing.assert_array_equal(result.value, right)
    assert result.is_complete


def test_the_scheduler_is_restarted(right, tmp_path):
    with cluster() as here:
        scheduler, worker = here.scheduler(), here.worker()

        def restart():
            for process in (scheduler, worker):
                os.kill(process.pid, signal.SIGKILL)
                process.wait()
            here.scheduler()
            here.worker()

        store = tmp_path / "a.zarr"
        result = sweep(**SPEC, scheduler=here.address, store=store, progress=after(3, restart))
    np.testing.assert_array_equal(result.value, right)
    assert result.is_complete
    assert result.reports[0].n_pieces == 12  # nothing twice


def test_the_scheduler_is_gone_and_the_sweep_goes_on_elsewhere(right, tmp_path):
    store = tmp_path / "a.zarr"
    with cluster() as here:
        processes = [here.scheduler(), here.worker()]
        with pytest.raises(SweepError, match="what is finished is kept"):
            sweep(
                **SPEC,
                scheduler=here.address,
                store=store,
                patience=3.0,
                progress=after(3, lambda: [os.kill(process.pid, signal.SIGKILL) for process in processes]),
            )
    result = sweep(**SPEC, store=store)
    assert result.n_reused >= 3
    np.testing.assert_array_equal(result.value, right)


def test_a_worker_of_another_version_is_not_asked(right):
    with cluster() as here:
        here.scheduler()
        here.worker(version="0.0.1")
        # The other one comes when the first has refused.
        late = threading.Timer(6.0, here.worker)
        late.start()
        result = sweep(**SPEC, scheduler=here.address)
        late.join()
    np.testing.assert_array_equal(result.value, right)
    assert len(result.remarks) == 1
    assert f"liepoisson {lp.__version__} is wanted; found 0.0.1" in result.remarks[0]


def test_no_worker_of_this_version_is_an_error():
    with cluster() as here:
        here.scheduler()
        here.worker(version="0.0.1")
        with pytest.raises(SweepError, match=r"found 0.0.1.*Install liepoisson"):
            sweep(**SPEC, scheduler=here.address, patience=3.0)


def test_all_workers_gone_is_an_error_after_patience(right, tmp_path):
    store = tmp_path / "a.zarr"
    with cluster() as here:
        here.scheduler()
        worker = here.worker()
        with pytest.raises(SweepError, match=r"no worker for 5 s; what is finished is kept.*--patience"):
            sweep(
                **SPEC,
                scheduler=here.address,
                store=store,
                patience=5.0,
                progress=after(3, lambda: os.kill(worker.pid, signal.SIGKILL)),
            )
    result = sweep(**SPEC, store=store)
    assert result.n_reused >= 3
    np.testing.assert_array_equal(result.value, right)


def test_a_new_worker_does_what_was_meant_for_one_that_is_gone(right):
    """The first one of the wrong version: the pieces are meant for the second one, and it is gone."""
    with cluster() as here:
        here.scheduler()
        here.worker(version="0.0.1")
        second = here.worker()

        def replace_it():
            os.kill(second.pid, signal.SIGKILL)
            here.worker()

        result = sweep(**SPEC, scheduler=here.address, progress=after(5, replace_it))
    np.testing.assert_array_equal(result.value, right)


def test_no_scheduler_is_an_error():
    with pytest.raises(SweepError, match="no scheduler answers"):
        sweep(**SPEC, scheduler=f"tcp://127.0.0.1:{free_port()}", patience=1.0)
    with pytest.raises(SweepError, match="no scheduler answers"):
        sweep(**SPEC, scheduler="bogus://x", patience=1.0)


def test_processes_say_nothing_on_the_way(tmp_path):
    """What Dask logs of its own processes is no message to the user."""
    script = tmp_path / "script.py"
    script.write_text(
        "import liepoisson as lp\n"
        "if __name__ == '__main__':\n"
        "    lp.sweep(system='heavy-top', axes={'a3': [0, 1]}, n_starts=2, t_end=5, processes=2)\n"
    )
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout + done.stderr == ""
    assert "DASK_DISTRIBUTED__LOGGING__DISTRIBUTED" not in os.environ
