# `make demo` and `make test` do all set-up by themselves.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test test-slow check clean

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

clean:
	rm -rf $(VENV) build demo
