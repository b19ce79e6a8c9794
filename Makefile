# `make demo` and `make test` do all set-up by themselves.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test test-slow check bench pictures clean

$(STAMP): pyproject.toml constraints.txt CMakeLists.txt $(shell find cpp -type f)
	PYTHON=$(PYTHON) sh tools/setup.sh $(VENV)
	touch $@

demo: $(STAMP)
	$(BIN)/explicable demo --out demo

check: $(STAMP)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

test: check
	$(BIN)/pytest -n 2 -m "not slow"

test-slow: $(STAMP)
	$(BIN)/pytest -n 2 -m slow

# The peers get an environment of their own; one that can't be installed is listed as absent in the page.
PEERS := .venv-bench
RUNS ?= 5

$(PEERS)/.installed: benchmarks/peers.txt
	$(PYTHON) -m venv $(PEERS)
	while read -r peer; do $(PEERS)/bin/pip install -q --disable-pip-version-check -c constraints.txt "$$peer" || echo "not installed: $$peer" >&2; done <$<
	touch $@

bench: $(STAMP) $(PEERS)/.installed
	$(BIN)/python benchmarks/run.py --runs $(RUNS) $(if $(TASKS),--tasks $(TASKS))

pictures: $(STAMP)
	$(BIN)/python tools/pictures.py

clean:
	rm -rf $(VENV) $(PEERS) build demo
