# `make demo` and the tests need Python 3.11 to 3.13, make and a package index; what they
# install goes into .venv and is done once.

SHELL := /bin/bash
.SHELLFLAGS := -euo pipefail -c
.DELETE_ON_ERROR:
.DEFAULT_GOAL := help
.PHONY: help demo check quick test tests test-slow test-view study endurance coverage docs wheel promises fuzz lint lock clean

# Any of these may be given on the command line: make PYTHON=python3.12 test
PYTHON ?=
DEMO := out/demo
SITE := out/site
# A study with its options, and the long tests of one folder.
NAME :=
ARGS :=
TESTS :=
MINUTES := 60
# Two more than the cores of a small machine: tests of nodes wait for half of their time.
WORKERS := 4

VENV := .venv
BIN := $(VENV)/bin
# uv takes 8 s where pip takes 40, but it does not read pip's configuration.
UV = index="$${PIP_INDEX_URL:-$$($(BIN)/python -m pip config get global.index-url 2>/dev/null || true)}"; \
    if [ -n "$$index" ]; then export UV_DEFAULT_INDEX="$$index"; fi; $(BIN)/uv
PYTEST = $(BIN)/python -m pytest -n $(WORKERS) --dist loadfile --no-loadscope-reorder

# Pages that the prose rule passes over: reports that commands write.
PROSE_REPORTS := docs/benchmark.md docs/interface.md docs/validation/* \
    $(addprefix docs/studies/,$(addsuffix .md,chaos discrepancy fuzz identification instruments motion \
    onset robustness soak))

# Tests of what needs no steady state.
QUICK := $(addprefix test/,bags config effects gear instruments launch messages model lab/reference_codes \
    core/test_schema.py core/test_resources.py test_layers.py)

# Nodes of a demo or test talk to nobody outside this machine.
export ROS_AUTOMATIC_DISCOVERY_RANGE := LOCALHOST

# The package asks for this itself, but tests import numpy before it.
export OPENBLAS_NUM_THREADS := 1

# A shell that has sourced a ROS 2 installation would mix its libraries with those in .venv.
ifdef ROS_DISTRO
unexport AMENT_PREFIX_PATH CMAKE_PREFIX_PATH COLCON_PREFIX_PATH LD_LIBRARY_PATH PYTHONPATH
unexport RMW_IMPLEMENTATION ROS_DISTRO ROS_PYTHON_VERSION ROS_VERSION
endif
unexport _ROS_WHEELS_BOOTSTRAP_COMPLETE

# Where it is set, each of the processes of a test or demo compiles all that it imports, again.
unexport PYTHONDONTWRITEBYTECODE

help:
	@echo 'make demo       a synthetic trial through the ROS graph, replayed, refitted, repaired: $(DEMO)/'
	@echo 'make check      style, types, imports and the quick tests'
	@echo 'make test       style, types and all tests but the long ones'
	@echo 'make test-slow  the long tests: commands that take minutes among them'
	@echo 'make study      one long run of the whole chain: NAME=coverage ARGS=--quick'
	@echo 'make endurance  the long tests at full size, hours: TESTS=soak'
	@echo 'make test-view  the tests of the viewer, which is installed before (170 MB)'
	@echo 'make fuzz       give all readers hostile input for MINUTES: docs/studies/fuzz.json'
	@echo 'make lint       style, types, layers and prose only'
	@echo 'make coverage   the tests of make test, and how much of the package they run'
	@echo 'make docs       build the site of guides and reference: $(SITE)/'
	@echo 'make wheel      build a wheel and an sdist, to install elsewhere: dist/'
	@echo 'make promises   run every command of the documents and write docs/promises.md'
	@echo 'make lock       choose the newest allowed versions and write requirements.lock'
	@echo 'make clean      remove .venv, out/ and what builds and tools leave behind'

demo: $(VENV)/ready
	@$(BIN)/trawl demo --out $(DEMO)

# Side by side: types take one core for as long as the quick tests take the other.
check: $(VENV)/ready
	@$(MAKE) --no-print-directory --jobs 2 lint quick

quick: $(VENV)/ready
	@$(PYTEST) -m 'not slow and not ros' $(QUICK)

test: lint tests

tests: $(VENV)/ready
	@$(PYTEST) -m 'not slow' test

test-slow: $(VENV)/ready
	@$(PYTEST) -m 'slow and not report' test

test-view: $(VENV)/ready
	@$(UV) pip install --quiet --python $(BIN)/python --constraint requirements.lock \
	    --no-build-isolation --editable '.[view]'
	@command -v chromium chromium-browser google-chrome > /dev/null || \
	    echo 'no browser for the page: apt-get install chromium'
	@ls /usr/share/vulkan/icd.d/*.json > /dev/null 2>&1 || \
	    echo 'no graphics for the viewer: apt-get install mesa-vulkan-drivers'
	@$(PYTEST) test/view test/promises -k 'view and not my_trial'

study: $(VENV)/ready
	@PYTHONPATH=test $(BIN)/python -m studies '$(NAME)' $(ARGS)

endurance: $(VENV)/ready
	@ENDURANCE=full $(BIN)/python -m pytest -m slow test/endurance/$(TESTS)

promises: $(VENV)/ready
	@$(BIN)/python -m pytest test/promises --write-promises

fuzz: $(VENV)/ready
	@PYTHONPATH=test/fuzz $(BIN)/python -m hostile --minutes $(MINUTES) --out docs/studies/fuzz.json

coverage: $(VENV)/ready
	@$(PYTEST) -m 'not slow' --cov --cov-fail-under=93 --cov-report=term:skip-covered test

docs: $(VENV)/ready
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict --site-dir $(SITE)
	@echo '$(SITE)/index.html is written'

# The wheel is built from the sdist, so that both are complete.
wheel: $(VENV)/ready
	@rm -rf dist
	@$(UV) build --quiet --no-build-isolation --python $(BIN)/python --out-dir dist
	@ls dist/*

lint: $(VENV)/ready
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports --no-cache > $(VENV)/layers.log || { cat $(VENV)/layers.log; exit 1; }
	@$(BIN)/pymarkdown scan --recurse $(patsubst %,--exclude '%',$(PROSE_REPORTS)) docs *.md

lock: $(VENV)/ready
	@$(UV) pip compile --quiet --upgrade --generate-hashes --universal --python-version 3.11 \
	    --extra ros --extra test --custom-compile-command 'make lock' \
	    --output-file requirements.lock setup.py
	@echo 'requirements.lock is written; the next make installs it'

clean:
	@rm -rf $(VENV) .nox out build install log dist *.egg-info .pytest_cache .ruff_cache .mypy_cache
	@find trawl_ros test -name __pycache__ -type d -prune -exec rm -rf {} +

# The folder of data and the metadata are read from this checkout (an editable install), so
# only a change of what is declared asks for another installation.
$(VENV)/ready: $(VENV)/locked setup.py setup.cfg pyproject.toml
	@echo '.venv: trawl_ros itself'
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-input \
	    --no-deps --no-build-isolation --editable .
	@echo '.venv: compiled loops of the model'
	@$(BIN)/python test/tools/compile_loops.py
	@touch $@

# What comes is held to the hashes in the lock, by uv and by pip, which gets its turn where uv cannot
# reach the package index.
$(VENV)/locked: requirements.lock | $(VENV)/bin/python
	@echo ".venv: $$(grep -c == requirements.lock) pinned packages (the longest step, 10 to 60 s)"
	@sed -n '/^uv==/,/^[^ ]/{/^uv==\|^ /p}' requirements.lock > $(VENV)/uv.lock
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-input \
	    --require-hashes --requirement $(VENV)/uv.lock
	@$(UV) pip install --quiet --python $(BIN)/python --require-hashes \
	    --requirement requirements.lock || { \
	    echo '.venv: uv failed, trying pip'; \
	    $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-input \
	        --require-hashes --requirement requirements.lock; }
	@touch $@

$(VENV)/bin/python:
	@for python in $(or $(PYTHON),python3 python3.12 python3.11 python3.13); do \
	    if "$$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 13))' \
	        2>/dev/null; then \
	        echo ".venv: $$("$$python" --version)"; \
	        "$$python" -m venv --clear $(VENV) && exit; \
	        rm -rf $(VENV); \
	        echo "$$python cannot make a virtual environment (on Debian and Ubuntu that needs" \
	            "the package python3-venv)" >&2; \
	        exit 1; \
	    fi; \
	done; \
	echo 'found no Python from 3.11 to 3.13 among:' \
	    '$(or $(PYTHON),python3 python3.12 python3.11 python3.13);' \
	    'name one with make PYTHON=...' >&2; \
	exit 1
