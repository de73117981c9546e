PYTHON ?= python3
BIN := .venv/bin

.PHONY: demo test quick trials docs notebooks coq proofs bench fuzz missions lint release clean
.DELETE_ON_ERROR:

# Prove a small vehicle's start, check the certificate, fly it; then the paper's vehicle. Everything lands in demo/.
demo: .venv/installed
	@mkdir -p demo
	@$(BIN)/hoverproof attraction crazyflie-2.1 --out demo/crazyflie-2.1.attraction.cert.json
	@$(BIN)/hoverproof check demo/crazyflie-2.1.attraction.cert.json
	@$(BIN)/hoverproof simulate crazyflie-2.1 --out demo/crazyflie-2.1.flight.nc --animate demo/crazyflie-2.1.flight.html
	@$(BIN)/hoverproof certify x4-flyer --out demo/x4-flyer.cert.json

# Everything that CI runs: style, types, the documentation and all tests. The documentation is built by
# one processor beside the tests; its own tests come last.
test: .venv/installed-docs
	@$(MAKE) --no-print-directory -j3 --output-sync=target lint docs checked
	$(BIN)/pytest -n auto tests/test_docs.py

.PHONY: checked
checked: .venv/installed-dev
	$(BIN)/pytest -n auto --dist worksteal --ignore tests/test_docs.py

# The fast tests only.
quick: .venv/installed-dev
	$(BIN)/pytest -n auto -m "not slow"

# What `make test` tries in part, whole: 3,000 missions against brute force, 1,500 flights, all mutants,
# every preset, the example with the machine vision toolbox, which is large.
trials: .venv/installed-compare
	$(BIN)/pytest -n auto --whole

lint: .venv/installed-dev
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# Make the notebooks anew from derivations/ and examples/, with their outputs.
notebooks: .venv/installed-compare
	$(BIN)/python notebooks/build.py

# Build the documentation, warnings as errors: docs/_build/html/index.html.
docs: .venv/installed-docs
	@echo "Building the documentation; its pages run the commands that they show: about two minutes."
	$(BIN)/python -m sphinx -b html -d docs/_build/doctrees -W --keep-going -q docs docs/_build/html
	@echo "The documentation: docs/_build/html/index.html"

# The theorems behind certificates, and these certificates, by the proof assistant Coq.
coq:
	@echo "Coq builds the library and replays all certificates: one or two minutes."
	@$(MAKE) --no-print-directory -C proofs/coq

# Make the certificates in proofs/ anew.
proofs: .venv/installed-dev
	$(BIN)/python proofs/make.py

# Speed, as ratios to peers in the same run; rewrites the tables in benchmarks/README.md.
bench: .venv/installed-dev
	$(BIN)/python benchmarks/closed_loop.py --write
	$(BIN)/python benchmarks/batch.py --write
	$(BIN)/python benchmarks/verdict.py --write
	$(BIN)/python benchmarks/firmware.py --write
	$(BIN)/python benchmarks/design.py --write
	$(BIN)/python benchmarks/commands.py --write
	$(BIN)/python benchmarks/tolerances.py --write
	$(BIN)/python benchmarks/eyes.py --write
	$(BIN)/python benchmarks/tour.py --write

# Ten million calls of the firmware with hostile inputs, under sanitizers (needs clang).
fuzz: .venv/installed-dev
	$(BIN)/python tests/fuzz_firmware.py

# Two thousand random mission files, valid, broken and absurd, through every command: takes hours.
missions: .venv/installed-dev
	$(BIN)/python tests/mission_trials.py --count 2000

# What is released, in dist/: sdist, wheel, and the documentation as pages that open without a build.
release: docs
	$(BIN)/python -m build --no-isolation
	@cd docs/_build && $(CURDIR)/$(BIN)/python -m zipfile -c \
	  $(CURDIR)/dist/hoverproof-$$($(CURDIR)/$(BIN)/hoverproof --version)-docs.zip html

.venv/installed: pyproject.toml
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@echo "Installing hoverproof and the packages that it needs into .venv, silently: it may take minutes."
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e .
	@touch $@

.venv/installed-dev: pyproject.toml
	@test -x $(BIN)/python || $(PYTHON) -m venv .venv
	@echo "Installing what tests and style checks need into .venv, silently: it may take minutes."
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[dev]"
	@touch .venv/installed $@

.venv/installed-compare: .venv/installed-dev
	@echo "Installing the packages that it is compared to into .venv, silently: it may take minutes."
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[compare]"
	@touch $@

.venv/installed-docs: .venv/installed-dev
	@echo "Installing what the documentation is built with into .venv, silently: it may take minutes."
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -e ".[docs]"
	@touch $@

clean:
	rm -rf .venv demo docs/_build docs/generated
