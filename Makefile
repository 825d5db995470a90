# Everything a person or CI runs by name. Each target sets up what it needs first.
#
#   make            build                    make bench    benchmarks, into build/bench
#   make demo       a small pick dataset     make soak     the tests that take minutes
#   make wheel      the package, into dist
#   make test       tests of each kind       make format   rewrite files in the project's style
#   make check      everything that finds    make docs     redraw pictures, build the site
#                   faults without a robot   make clean    remove what was built (not .venv)
#
# make check is the sum of: check-format check-lint check-types check-rules check-docs check-site check-proofs
# check-subdirectory check-wheel check-tidy check-sanitizers check-fuzz; each can be run alone. make soak adds check-tsan.

SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := build
MAKEFLAGS += --no-print-directory
.NOTPARALLEL:

JOBS ?= $(shell nproc)
# Processes of tests: one more, since tests wait for disks, deadlines and processes that they started.
TESTERS = $(shell echo $$(($(JOBS) + 1)))
ROOT := $(CURDIR)
PYTHON := .venv/bin/python

export PATH := $(ROOT)/.venv/bin:$(PATH)
export PYTHONPATH := $(ROOT)/python
# What Python compiled, of packages too, is kept for the hundreds of processes that tests start, but not among the sources.
export PYTHONDONTWRITEBYTECODE :=
export PYTHONPYCACHEPREFIX := $(ROOT)/build/pycache
# Two checkouts share compiler results.
export CCACHE_BASEDIR := $(ROOT)
export CCACHE_NOHASHDIR := 1

CXX_FILES = $$(git ls-files --cached --others --exclude-standard '*.cc' '*.h')
headline = printf '\n=== %s ===\n' "$(1)"

.PHONY: build build-python setup demo test test-cc test-python check check-format check-lint check-types \
  check-rules check-docs check-site site check-proofs check-subdirectory check-wheel check-tidy check-sanitizers check-fuzz check-tsan check-tsan-cc \
  check-tsan-python wheel bench soak \
  soak-reliability soak-tests soak-debug soak-fuzz clean format docs

setup:
	@scripts/setup

build: setup
	@$(call headline,build)
	@$(call configure,release) -DROBOCELL_PYTHON=ON
	@cmake --build --preset release -j $(JOBS)

# The library and the Python extension with its stubs, without tests and examples.
build-python: setup
	@$(call headline,build)
	@$(call configure,release) -DROBOCELL_PYTHON=ON
	@cmake --build --preset release -j $(JOBS) --target robocell _core _core_stubs

# The documentation site, into build/site/html, and the notebooks, which are run if they or the package changed. A
# warning is an error.
build_site = mkdir -p build/site; NO_MKDOCS_2_WARNING=1 $(PYTHON) -m mkdocs build --strict >build/site/build.log 2>&1 \
  || { cat build/site/build.log; exit 1; }

# configure PRESET [options]: quiet when it goes well, the whole log when it does not
configure = configure() { preset=$$1; shift; mkdir -p build/$$preset; \
  cmake --preset $$preset -DPython_EXECUTABLE=$(ROOT)/$(PYTHON) "$$@" \
    >build/$$preset/configure.log 2>&1 || { cat build/$$preset/configure.log; exit 1; }; }; \
  configure $(1)

demo: build-python
	@$(call headline,demo)
	@$(PYTHON) -m robocell generate examples/demo.yaml

test: test-cc test-python

test-cc: build
	@$(call headline,C++ tests)
	@scripts/fetch_test_robots
	@ctest --preset release -j $(TESTERS) --no-tests=error --progress

test-python: build
	@$(call headline,Python tests)
	@scripts/fetch_test_robots
	@$(PYTHON) -m pytest -n $(TESTERS) --dist worksteal

check: check-format check-lint check-rules check-docs check-types check-site check-proofs check-subdirectory check-wheel check-tidy check-sanitizers check-fuzz
	@$(call headline,make check: nothing found)

check-format: setup
	@$(call headline,format)
	@clang-format --dry-run -Werror $(CXX_FILES)
	@ruff format --check --quiet . || { ruff format --check .; exit 1; }

check-lint: setup
	@$(call headline,lint)
	@ruff check .

check-rules: setup
	@$(call headline,includes and house rules)
	@$(PYTHON) scripts/check_includes.py
	@$(PYTHON) scripts/check_rules.py

check-docs: setup
	@$(call headline,docs)
	@$(PYTHON) scripts/check_docs.py

# Every notebook runs, every link and reference of the site leads somewhere.
check-site: build-python
	@$(call headline,site and notebooks)
	@$(build_site)

# What the pages promise, and what holds for every robot: `make test` tries some of each kind.
check-proofs: build
	@$(call headline,proofs in full)
	@cmake --build --preset release -j $(JOBS) --target examples
	@scripts/fetch_test_robots
	@layers=$$(git grep -l 'LongForm()' -- 'src/robocell/*_test.cc' | cut -d/ -f3 | sort -u | paste -sd'|'); \
	  ROBOCELL_LONG_FORM=1 ctest --preset release -j $(JOBS) --no-tests=error --progress -L "^($$layers)$$"
	@$(PYTHON) -m pytest -q -n $(TESTERS) --dist worksteal -m "proof and not soak"

# Types come from the extension's stubs, so it is built first.
check-types: build-python
	@$(call headline,types)
	@mypy

# The build folder is only configured, for the commands.
check-tidy: setup
	@$(call headline,clang-tidy)
	@$(call configure,tidy)
	@$(PYTHON) scripts/tidy.py --build build/tidy --jobs $(JOBS)

check-sanitizers: setup
	@$(call headline,C++ tests under ASan and UBSan)
	@$(call configure,asan)
	@cmake --build --preset asan -j $(JOBS)
	@scripts/fetch_test_robots
	@ctest --preset asan -j $(JOBS) --no-tests=error --progress

# Longer by hand: make check-fuzz FUZZ_SECONDS=3600
FUZZ_SECONDS ?= 60
check-fuzz: setup
	@$(call headline,fuzzing what strangers may have written)
	@$(call configure,fuzz)
	@cmake --build --preset fuzz -j $(JOBS)
	@scripts/fuzz $(FUZZ_SECONDS)

# A project with robocell in its tree. With make and not with ninja, whose paths would be others than those of the
# release build: ccache has the objects.
check-subdirectory: setup
	@$(call headline,robocell within another project)
	@mkdir -p build/subdirectory
	@cmake -S tests/subdirectory -B build/subdirectory -G "Unix Makefiles" -DCMAKE_BUILD_TYPE=Release \
	  >build/subdirectory/configure.log 2>&1 || { cat build/subdirectory/configure.log; exit 1; }
	@$(MAKE) --directory build/subdirectory --jobs $(JOBS) subdirectory
	@build/subdirectory/subdirectory

# The wheel that users install, in dist. ccache has its objects after make.
wheel: setup
	@$(call headline,wheel)
	@scripts/build_wheel

# The wheel, built and tried in an environment of its own. Needs a network: pip installs what it requires.
check-wheel: build-python
	@$(call headline,wheel in a clean environment)
	@$(PYTHON) -m pytest -q -m wheel tests/integration/test_wheel.py

bench: setup
	@$(call headline,benchmarks)
	@$(call configure,release) -DROBOCELL_BENCHMARKS=ON
	@cmake --build --preset release -j $(JOBS)
	@$(PYTHON) benchmarks/run.py

# The long form of what make test does quickly: kills, full disks, damage, leaks, fuzzing,
# races. Then `scripts/soak_figures.py` writes the figures into docs/reliability.md. An hour or more, on
# a machine that does nothing else (times are compared); `make --keep-going soak` goes on after a failure.
SOAK_FUZZ_SECONDS ?= 600
soak: soak-reliability soak-tests soak-debug check-tsan soak-fuzz

soak-reliability: build
	@$(call headline,soak: whatever dies)
	@scripts/fetch_test_robots
	@mkdir -p build/soak && rm -f build/soak/figures.jsonl
	@ROBOCELL_FIGURES=$(ROOT)/build/soak/figures.jsonl $(PYTHON) -m pytest -n $(JOBS) --dist loadfile \
	  -m "soak or not soak" tests/reliability

soak-tests: build
	@$(call headline,soak: long tests)
	@scripts/fetch_test_robots
	@mkdir -p build/soak
	@ROBOCELL_FIGURES=$(ROOT)/build/soak/figures.jsonl $(PYTHON) -m pytest -m soak --ignore tests/reliability

# What optimisation hides: nothing is inlined, so that two things of one name meet in the linker.
soak-debug: setup
	@$(call headline,soak: C++ tests without optimisation)
	@$(call configure,debug)
	@cmake --build --preset debug -j $(JOBS)
	@scripts/fetch_test_robots
	@ctest --preset debug -j $(JOBS) --no-tests=error --progress

soak-fuzz:
	@$(MAKE) check-fuzz FUZZ_SECONDS=$(SOAK_FUZZ_SECONDS)

# Not part of make check: the second build of everything takes longer than all of the rest.
check-tsan: check-tsan-cc check-tsan-python

check-tsan-cc: setup
	@$(call headline,threads under ThreadSanitizer)
	@$(call configure,tsan) -DROBOCELL_PYTHON=ON
	@cmake --build --preset tsan -j $(JOBS) --target threads_test base_test mujoco_test
	@ctest --preset tsan -L '^(threads|base|mujoco)$$' --no-tests=error --progress

# The same for what Python does in several threads (tests/threads), with an extension that is
# instrumented.
check-tsan-python: setup
	@$(call headline,threads of Python under ThreadSanitizer)
	@$(call configure,tsan) -DROBOCELL_PYTHON=ON
	@cmake --build --preset tsan -j $(JOBS) --target _core
	@scripts/tsan_python

format: setup
	@clang-format -i $(CXX_FILES)
	@ruff check --fix-only --quiet .
	@ruff format .

docs: build
	@$(call headline,docs)
	@$(PYTHON) scripts/make_pictures.py
	@for script in docs/make_*.py; do if [ -e "$$script" ]; then $(PYTHON) "$$script"; fi; done
	@$(PYTHON) scripts/check_docs.py
	@$(MAKE) site

# The site alone, with the pictures as they are.
site: build-python
	@$(call headline,site)
	@$(build_site)
	@echo 'open build/site/html/index.html'

clean:
	rm -rf build dist
