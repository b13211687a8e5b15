# Needs make and Python 3.11 or newer. Everything else goes into .venv, as locked.
# With another Python than `python3`: make PYTHON=python3.12 demo

PYTHON ?= python3
BIN = .venv/bin
READY = .venv/.ready
DEVELOP = .venv/.ready-develop
TEXTS = pipeline/locale/nl/LC_MESSAGES/herijk.po
DEMO = demo
DEMO_WORLD = --seasons 2009:2018 --tows-per-season 10 --rate 1000 --seed 1

# Containers often forbid Python to keep compiled modules; every command would compile Dagster again.
unexport PYTHONDONTWRITEBYTECODE
export DAGSTER_DISABLE_TELEMETRY = 1
export DAGSTER_DG_UPDATE_CHECK_ENABLED = 0

.PHONY: help env demo test test-more slow texts lint wheel docs pictures bench growth accuracy clean

help:
	@echo "make demo   simulate an archive of ten seasons and rebuild its history"
	@echo "make test   run all tests but those below"
	@echo "make test-more  run the tests that rebuild again and again, use a browser, or kill processes"
	@echo "make slow   run the tests that take half a minute and more each"
	@echo "make texts  find the texts that are said, and put those without Dutch in $(TEXTS)"
	@echo "make lint   check style, types, imports and the Dagster definitions"
	@echo "make wheel  build the wheel and try it in a clean environment"
	@echo "make docs   make the documents and the reference as pages, in docs/_build"
	@echo "make pictures  take the pictures of README.md from the demo's site"
	@echo "make bench  measure speed and memory"
	@echo "make growth measure them from one to three thousand tows"
	@echo "make accuracy  how near the truth the rebased history comes in every simulated world; it can be stopped"
	@echo "make env    make the environment in .venv, and nothing more"
	@echo "make clean  remove the environment, the demo and the caches"

env: $(READY)

# uv takes seconds where pip takes a minute; pip knows mirrors that uv does not.
define install
  $(BIN)/uv pip install --quiet --python $(BIN)/python --no-deps --require-hashes --requirement $(1) || \
  $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile \
    --no-deps --require-hashes --requirement $(1)
endef

$(READY): requirements-uv.lock requirements.lock pyproject.toml hatch_build.py
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { \
	  echo "Herijk needs Python 3.11 or newer, and $(PYTHON) is not. Name one that is, for example: make PYTHON=python3.12 env" >&2; \
	  exit 1; }
	@echo "Making the environment in .venv; the first time this takes up to a minute."
	@$(PYTHON) -m venv --clear .venv
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile \
	  --no-deps --require-hashes --requirement requirements-uv.lock
	@$(call install,requirements.lock)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check \
	  --no-deps --no-build-isolation --editable .
	@touch $(READY)

# What tests, checks and benchmarks need besides.
$(DEVELOP): $(READY) requirements-dev.lock
	@echo "Adding what tests and checks need."
	@$(call install,requirements-dev.lock)
	@touch $(DEVELOP)

$(TEXTS:.po=.mo): $(TEXTS) $(wildcard dashboards/templates/*.j2) $(READY)
	@$(BIN)/python hatch_build.py

demo: $(READY) $(TEXTS:.po=.mo) $(DEMO)/archief
	@$(BIN)/herijk rebuild --archive $(DEMO)/archief --data $(DEMO)/data
	@echo
	@echo "These were simulated boats. The archive is $(DEMO)/archief. Open the site in a browser:"
	@echo "  $(DEMO)/data/site/index.html"
	@echo "Where the numbers of one boat come from:"
	@echo "  $(BIN)/herijk audit FSN106 --data $(DEMO)/data"

# The archive is put in place when it is complete, so a folder that is there is whole.
$(DEMO)/archief: | $(READY)
	@echo "Simulating an archive of ten seasons; this takes a minute."
	@rm -f $(DEMO)/archief-truth.json
	@$(BIN)/herijk simulate $(DEMO)/archief $(DEMO_WORLD)

# A worker more than two cores, since some wait for a browser or another process; threads of their
# own would fight over the cores.
test test-more slow: export POLARS_MAX_THREADS = 1
test test-more slow: export OPENBLAS_NUM_THREADS = 1

# By their marks. CI runs TESTS="not slow", so that what tests share is made once.
TESTS ?= not more and not slow

test: $(DEVELOP)
	@$(BIN)/python -m pytest -n 3 --dist worksteal -m "$(TESTS)"

test-more: $(DEVELOP)
	@$(BIN)/python -m pytest -n 3 --dist worksteal -m "more and not slow"

slow: $(DEVELOP)
	@$(BIN)/python -m pytest -n 2 --dist worksteal -m slow

texts: $(DEVELOP)
	@$(BIN)/python -m tests.texts
	@$(BIN)/python hatch_build.py

lint: $(DEVELOP)
	@$(BIN)/python -m tests.texts --check
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .
	@$(BIN)/mypy
	@$(BIN)/lint-imports --no-logo
	@VIRTUAL_ENV="$(CURDIR)/.venv" $(BIN)/dg check defs --no-check-yaml

wheel: $(DEVELOP)
	@.ci/wheel

# Warnings are errors: a link or a reference that leads nowhere.
docs: $(DEVELOP)
	@$(BIN)/python -m sphinx -q -W -b html docs docs/_build

pictures: demo $(DEVELOP)
	@$(BIN)/python docs/pictures/draw.py

# A thousand tows: ten minutes to simulate, once. A minute: make bench TOWS=1 REPEATS=1
TOWS ?= 60
REPEATS ?= 5

bench: $(DEVELOP)
	@PYTHONPATH=. $(BIN)/python -m benchmarks.speed --tows-per-season $(TOWS) --repeats $(REPEATS) \
	  --write $(if $(filter 60,$(TOWS)),benchmarks/results/speed.md,benchmarks/data/performance.md)
	@PYTHONPATH=. $(BIN)/python -m benchmarks.commands benchmarks/data/$(TOWS)/archive \
	  --write $(if $(filter 60,$(TOWS)),benchmarks/results/commands.md,benchmarks/data/commands.md)

# An hour.
growth: $(DEVELOP)
	@PYTHONPATH=. $(BIN)/python -m benchmarks.commands --growth 60 180 --write benchmarks/results/growth.md

# Every named world: two hours on two cores for 20 archives each. A first look: make accuracy SEEDS=2
SEEDS ?= 20
PROCESSES ?= 2

accuracy: $(DEVELOP)
	@PYTHONPATH=. $(BIN)/python -m benchmarks.accuracy.worlds --seeds $(SEEDS) --processes $(PROCESSES)

clean:
	rm -rf .venv $(DEMO) dist docs/_build .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
