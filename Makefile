# Everything installs into .venv from the package registries, from lock files; nothing else on the machine is touched.
SHELL := /bin/bash
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
RUST_SOURCES := $(shell find crates -name '*.rs' -o -name Cargo.toml) Cargo.toml Cargo.lock
OUT ?= results/twisted-top
export MPLBACKEND := Agg
# The tests have a worker on each core: threads of NumPy's small decompositions would wait for one another.
test-python quick-tests test-as test-slow: export OPENBLAS_NUM_THREADS := 1
# Otherwise each of some hundred processes of the tests would compile the package again, and each worker all the tests.
unexport PYTHONDONTWRITEBYTECODE

.DEFAULT_GOAL := help

help: ## list the recipes
	@grep -E '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1\t/' | expand -t 18

reproduce: $(VENV)/.built ## set up, then reproduce the paper: figure, data, claims and report in results/twisted-top
	$(BIN)/liepoisson reproduce twisted-top --out $(OUT)

# The extension is compiled by one thread; the Rust tests are compiled and run beside it, in a folder of their own.
test: | tools ## set up, then run the tests (some 28 minutes from nothing on two cores)
	@$(MAKE) --no-print-directory -j 2 set-up test-rust
	@$(MAKE) --no-print-directory test-python

test-slow: $(VENV)/.built $(VENV)/.notebooks $(VENV)/browser $(VENV)/floors ## the anchors at full size (20,000 members), real notebooks, `make arm`, the oldest versions
	$(BIN)/pytest -m slow

# The bits of the results are those that x86 has (crates/liepoisson-core/tests/core/same_bits.txt). Part of `make test-slow`.
arm: $(VENV)/.dev ## the core's tests on an emulated ARM processor (15 minutes; says what it needs)
	$(BIN)/pytest -m slow -rs -s tests/test_arm.py

check: $(VENV)/.built lint ## format, lint, types and the quick tests of CONTRIBUTING.md (two minutes on two cores)
	@$(MAKE) --no-print-directory -j 2 types quick-tests

static: lint types ## the part of `make check` that runs no test

lint: $(VENV)/.dev
	cargo fmt --check -- $(filter crates/liepoisson-core/src/method/%,$(RUST_SOURCES))  # that a table declares
	cargo clippy --workspace --all-targets --locked --quiet -- -D warnings
	$(BIN)/ruff format --check
	$(BIN)/ruff check

types: $(VENV)/.dev
	$(BIN)/basedpyright

quick-tests:
	$(BIN)/pytest -n auto --dist worksteal --quick

guard: instructions sanitize miri wheel-check ## what guards the build: instruction counts, sanitizer, Miri, the wheel without Rust

audit: $(VENV)/.built ## evidence for each method: orders, drift, Poisson maps, work and precision (an hour; resumes)
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/dev.txt
	$(BIN)/python verification/run.py

# Before a change of the package's inside, and after it: `python -m verification.corpus.compare BEFORE results/corpus` prints
# what differs (verification/corpus/record.py).
corpus: $(VENV)/.built ## record what the package answers into results/corpus (some six minutes of one core)
	$(BIN)/python -m verification.corpus.record --out results/corpus

bench: $(VENV)/.built ## speed against heyoka.py and other tools, side by side (some 100 minutes; leave the machine alone meanwhile)
	$(BIN)/python benchmarks/run.py
	$(BIN)/python benchmarks/general.py --avx2
	$(BIN)/python benchmarks/commands.py
	$(BIN)/python benchmarks/spectra.py
	$(BIN)/python benchmarks/periodic.py

# As the editable install builds it, so that what is compiled serves both.
wheel: | $(VENV)/.build ## build the wheel into dist/
	rm -rf dist
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/pip wheel --quiet --disable-pip-version-check --no-deps --no-build-isolation \
	  --wheel-dir dist .

LOCK := --universal --python-version 3.11 --generate-hashes --no-header --quiet
lock: | $(VENV)/.run ## refresh the lock files from pyproject.toml
	$(BIN)/pip install --quiet uv
	$(BIN)/uv pip compile pyproject.toml $(LOCK) --upgrade --output-file requirements/run.txt
	$(BIN)/uv pip compile --group build $(LOCK) --upgrade --output-file requirements/build.txt
	$(BIN)/uv pip compile pyproject.toml --extra notebook --group test --group lint $(LOCK) \
	  --constraint requirements/run.txt --output-file requirements/dev.txt
	$(BIN)/uv pip compile pyproject.toml --extra notebook --group notebooks $(LOCK) --upgrade \
	  --constraint requirements/dev.txt --output-file requirements/notebooks.txt
	$(BIN)/uv pip compile --group docs $(LOCK) --upgrade --constraint requirements/dev.txt \
	  --output-file requirements/docs.txt
	$(BIN)/uv pip compile pyproject.toml --extra notebook --group test $(LOCK) --upgrade --resolution lowest-direct \
	  --output-file requirements/floors.txt
	$(BIN)/uv pip compile --group browser $(LOCK) --constraint requirements/dev.txt --output-file requirements/browser.txt
	cargo update

wasm: ## build the core for the browser (5 minutes; says what it needs); it is committed, with a hash of its sources
	$(PYTHON) web/build_core.py

lab: $(VENV)/.built ## set up, then open the laboratory in the browser (SYSTEM=kirchhoff for another system)
	$(BIN)/liepoisson lab $(SYSTEM)

page: ## build the laboratory's page (needs node and npm); it is committed, with a hash of its sources
	$(PYTHON) web/build_page.py

test-web: ## the tests of the page in node and in Chromium (needs both)
	cd web && npm ci --no-audit --no-fund && npm test && npm run build && node test/page.mjs

docs: $(VENV)/.built $(VENV)/.docs ## build the documentation site into target/site/html, without downloads (OPTIONS=--rust: with the core's pages)
	$(BIN)/python docs/site/build.py $(OPTIONS)

docs-check: docs ## check the site: links, no request to another host, and pages in Chromium (where node and Chromium are there)
	$(BIN)/python docs/site/check.py

stories: $(VENV)/.built $(VENV)/.notebooks ## run the notebooks of docs/stories again and store what they print and draw (a minute)
	$(BIN)/python docs/stories/make.py

# Python by pip-audit (in the environment or on the path), Rust by cargo-audit. Both ask public lists, so they need the network.
LOCKED := requirements/run.txt requirements/dev.txt requirements/build.txt requirements/docs.txt requirements/notebooks.txt \
  requirements/browser.txt
PIP_AUDIT = $(firstword $(wildcard $(BIN)/pip-audit) $(shell command -v pip-audit 2>/dev/null))
vulnerabilities: ## ask public lists about known vulnerabilities in the lock files of Python and Rust (needs the network)
	@failed=0; \
	if [ -n "$(PIP_AUDIT)" ]; then \
	  for lock in $(LOCKED); do \
	    echo "$$lock"; $(PIP_AUDIT) --strict --disable-pip --require-hashes --progress-spinner off --requirement $$lock || failed=1; \
	  done; \
	else echo "Python: skipped: install pip-audit (pipx install pip-audit)"; fi; \
	if command -v cargo-audit >/dev/null; then echo Cargo.lock; cargo audit --deny warnings || failed=1; \
	else echo "Rust: skipped: install cargo-audit (cargo install --locked cargo-audit)"; fi; \
	exit $$failed

release-check: ## is everything ready for a release? (docs/releasing.md; runs all tests; OPTIONS="--only version tree": a part)
	@$(PYTHON) .ci/release.py $(OPTIONS)

clean: ## remove everything that the recipes make, results excepted
	rm -rf $(VENV) target dist python/liepoisson/*.so

.PHONY: help lab reproduce test test-rust test-python test-as test-slow check static lint types quick-tests arm bench audit corpus guard instructions \
  sanitize miri wasm page test-web docs docs-check stories wheel wheel-check vulnerabilities release-check lock clean set-up tools

# One pip after the other.
set-up: $(VENV)/.dev
	@$(MAKE) --no-print-directory $(VENV)/.built

# By name, since `cargo test` would compile the example, too.
test-rust: | tools
	cargo test --locked --quiet -p liepoisson-core --lib --test core
	cargo test --locked --quiet -p liepoisson-core --doc
	cargo test --locked --quiet -p liepoisson-formula

# Each instruction set that the processor has gets its turn; results must not depend on it.
test-python:
	$(BIN)/python -m mypy.stubtest liepoisson._core --mypy-config-file pyproject.toml
	$(BIN)/pytest -n auto --dist worksteal -m "not slow"

# Four libraries are told to choose their kernels as on an older processor: .ci/as_processor.py.
TESTS ?= tests
test-as: $(VENV)/.built $(VENV)/.dev ## the tests as on another processor: PROCESSOR=avx2 or no-avx (TESTS="...": a part)
	$(BIN)/python .ci/as_processor.py $(PROCESSOR) $(BIN)/pytest -n auto --dist worksteal -m "not slow" $(TESTS)

instructions: | tools
	$(PYTHON) benchmarks/instructions.py

# All unsafe code is in the core's lanes, tiles and compiled code (jit, which Miri cannot run); these tests run every kernel in every
# register. The sanitizer comes with the stable toolchain, its flag does not: hence RUSTC_BOOTSTRAP.
SANITIZED := ensemble:: mixed_taylor:: quadratic:: splitting:: top::
sanitize: | tools
	@if [ "$$(uname -sm)" = "Linux x86_64" ]; then \
	  export RUSTC_BOOTSTRAP=1 RUSTFLAGS=-Zsanitizer=address CARGO_TARGET_DIR=target/sanitize PROPTEST_CASES=16; \
	  cargo test --locked --quiet -p liepoisson-core --target x86_64-unknown-linux-gnu --lib && \
	  cargo test --locked --quiet -p liepoisson-core --target x86_64-unknown-linux-gnu --test core -- $(SANITIZED); \
	else echo "sanitize: skipped, it is set up for Linux on x86-64"; fi

# What the sanitizer does not see: where a pointer came from, and alignment. In Miri there is one register type, the scalar one
# (it finds no AVX and is shown no NEON), and thousands of times less speed, so the tests are those of lanes and tiles, in few cases; once under each
# of the two models of what a pointer may be used for. It needs a nightly toolchain with miri and rust-src.
MIRIFLAGS_BOTH := -Zmiri-disable-isolation -Zmiri-ignore-leaks
miri: | tools
	@if cargo +nightly miri --version >/dev/null 2>&1 && cargo +nightly miri setup >/dev/null 2>&1; then \
	  for model in "" -Zmiri-tree-borrows; do \
	    MIRIFLAGS="$(MIRIFLAGS_BOTH) $$model" PROPTEST_CASES=2 PROPTEST_DISABLE_FAILURE_PERSISTENCE=1 CARGO_TARGET_DIR=target/miri \
	      cargo +nightly miri test --locked --quiet -p liepoisson-core --lib -- lanes convolution || exit 1; \
	  done; \
	else echo "miri: skipped, there is no nightly toolchain with it (rustup +nightly component add miri rust-src)"; fi

# The wheel in an environment of its own that sees no Rust.
wheel-check: wheel
	rm -rf target/wheel-check && $(PYTHON) -m venv target/wheel-check
	target/wheel-check/bin/pip install --quiet --require-hashes -r requirements/run.txt
	target/wheel-check/bin/pip install --quiet --no-deps --no-index dist/*.whl
	cd target/wheel-check && env -u PYTHONPATH PATH=/usr/bin:/bin bin/python $(CURDIR)/.ci/first_result.py
	cd target/wheel-check && env PATH=/usr/bin:/bin bin/liepoisson reproduce twisted-top --members 50 --end-time 60 --out study
	test -s target/wheel-check/study/report.html

tools:
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || \
	  { echo "liepoisson needs Python 3.11 or newer as '$(PYTHON)'. Install it from python.org or your system's packages, or name one: make PYTHON=python3.12 ..." >&2; exit 2; }
	@$(PYTHON) -c 'import venv, ensurepip' 2>/dev/null || \
	  { echo "This Python lacks venv and ensurepip. On Debian and Ubuntu: apt install python3-venv" >&2; exit 2; }
	@command -v cargo >/dev/null || \
	  { echo "liepoisson needs a Rust toolchain (1.89 or newer). Install it from https://rustup.rs" >&2; exit 2; }
	@command -v cc >/dev/null || \
	  { echo "Rust needs a C linker. On Debian and Ubuntu: apt install gcc libc6-dev; on macOS: xcode-select --install" >&2; exit 2; }

$(VENV)/.run: requirements/run.txt | tools
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/run.txt
	touch $@

$(VENV)/.dev: requirements/dev.txt | $(VENV)/.run
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/dev.txt
	touch $@

$(VENV)/.notebooks: requirements/notebooks.txt | $(VENV)/.dev
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/notebooks.txt
	touch $@

# For Pyodide, in which node runs the tests of the exact algebra: its version of Python, its platform.
$(VENV)/browser: requirements/browser.txt | $(VENV)/.run
	rm -rf $@
	$(BIN)/pip download --quiet --disable-pip-version-check --require-hashes --no-deps --only-binary=:all: --python-version 3.14 \
	  --implementation cp --abi cp314 --platform pyemscripten_2026_0_wasm32 -r requirements/browser.txt --dest $@
	if command -v npm >/dev/null; then npm ci --prefix web --no-audit --no-fund; fi

# Every direct dependency at the floor that pyproject.toml declares, for tests/test_floors.py.
$(VENV)/floors: requirements/floors.txt | tools
	rm -rf $@
	$(PYTHON) -m venv $@
	$@/bin/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/floors.txt

$(VENV)/.build: requirements/build.txt | $(VENV)/.run
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/build.txt
	touch $@

$(VENV)/.docs: requirements/docs.txt | $(VENV)/.run
	$(BIN)/pip install --quiet --disable-pip-version-check --require-hashes -r requirements/docs.txt
	touch $@

$(VENV)/.built: $(VENV)/.run $(VENV)/.build $(RUST_SOURCES) pyproject.toml
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	touch $@
