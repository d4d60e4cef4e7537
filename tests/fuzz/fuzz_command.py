"""Fuzzing of names, files and the arguments of the command; run by hand, not by pytest.

    PYTHONPATH=python python tests/fuzz/fuzz_command.py --runs 2000 --seed 1
    PYTHONPATH=python python tests/fuzz/fuzz_command.py --minutes 10 --seed 2

Each run writes a system file and a sweep file with hostile names, labels, formulas and numbers into a new folder and
runs a command on them in this process.  It fails on a traceback, on an exit code that is not documented, on a refusal
without a reason, and on a run of more than 20 seconds of the processor.  A failure prints the seed of its run, which
`--only SEED` repeats.  At the end the number of accepted, refuted and refused commands is printed.
"""

import argparse
import random
import resource
import sys
import tempfile
import time
import warnings
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1] / "exact"))

from hostile_commands import ComplaintError, Source, command, run


def main():
    options = argparse.ArgumentParser()
    options.add_argument("--runs", type=int, default=1000)
    options.add_argument("--minutes", type=float, default=float("inf"))
    options.add_argument("--seed", type=int, default=0)
    options.add_argument("--only", type=int)
    given = options.parse_args()
    resource.setrlimit(resource.RLIMIT_AS, (6 * 2**30, 6 * 2**30))
    warnings.simplefilter("ignore")
    ends = time.monotonic() + 60 * given.minutes
    seeds = [given.only] if given.only is not None else range(given.seed * 10**6, given.seed * 10**6 + given.runs)
    codes, complaints = Counter(), 0
    for seed in seeds:
        if time.monotonic() > ends:
            break
        arguments, files = command(Source(random.Random(seed)))
        with tempfile.TemporaryDirectory() as folder:
            try:
                codes[run(arguments, files, folder, seconds=20.0)[0]] += 1
            except ComplaintError as complaint:
                complaints += 1
                print(f"seed {seed}: {complaint}\n", flush=True)
    print(f"{codes.total() + complaints} commands: exit codes {dict(codes)}, {complaints} complaints")
    sys.exit(bool(complaints))


if __name__ == "__main__":
    main()
