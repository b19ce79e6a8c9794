# `make demo` and `make test` do all set-up by themselves.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test test-slow sanitize check bench evaluate pictures clean

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

# The core with address and undefined-behaviour sanitizers, in an environment of its own; and the tests that exercise it.
# The sanitizer's library comes before everything else, and libstdc++ with it, so that it sees C++ exceptions.
# Python keeps memory to its end, so leaks are not looked for.
SANITIZED := .venv-sanitize
# The sanitized core tells of objects that outlive Python, about which the other is silent: one test is about that.
TELLS_OF_LEAKS := tests/model/test_task.py::test_a_process_may_end_while_a_thread_holds_a_task
SANITIZED_TESTS := tests/search tests/model $(addprefix tests/labelling/test_,chain.py crf.py loss.py scorer.py least_objective.py)

$(SANITIZED)/.installed: pyproject.toml constraints.txt CMakeLists.txt $(shell find cpp -type f)
	CMAKE_ARGS=-DEXPLICABLE_SANITIZE=ON PYTHON=$(PYTHON) sh tools/setup.sh $(SANITIZED)
	touch $@

sanitize: $(SANITIZED)/.installed
	LD_PRELOAD="$$($(CXX) -print-file-name=libasan.so) $$($(CXX) -print-file-name=libstdc++.so)" \
	ASAN_OPTIONS=detect_leaks=0 UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 \
	$(SANITIZED)/bin/python -m pytest -m "not slow" --deselect $(TELLS_OF_LEAKS) $(SANITIZED_TESTS)

# The peers get an environment of their own; one that can't be installed is listed as absent in the page.
PEERS := .venv-bench
RUNS ?= 3

$(PEERS)/.installed: benchmarks/peers.txt
	$(PYTHON) -m venv $(PEERS)
	while read -r peer; do $(PEERS)/bin/pip install -q --disable-pip-version-check -c constraints.txt "$$peer" || echo "not installed: $$peer" >&2; done <$<
	touch $@

bench: $(STAMP) $(PEERS)/.installed
	$(BIN)/python benchmarks/run.py --runs $(RUNS) $(if $(TASKS),--tasks $(TASKS))

# Interrupted, it goes on where it was; JOBS processes, QUICK=1 for small numbers.
evaluate: $(STAMP)
	$(BIN)/explicable evaluate --jobs $(or $(JOBS),2) $(if $(QUICK),--quick)

pictures: $(STAMP)
	$(BIN)/python tools/pictures.py
	$(BIN)/python tools/study_pictures.py

clean:
	rm -rf $(VENV) $(SANITIZED) $(PEERS) build demo
