# Every target does its own set-up. Extra flags: make reproduce ARGS="--cores 1". Another interpreter: make test PYTHON=/opt/python/bin/python3.12

ARGS   =
PYTHON = python3.13 python3.12 python3.11 python3
# Programs run as `python -m`, for the scripts in .venv/bin hold absolute paths and would run the original's files in a copy of the tree.
RUN       = .venv/bin/python
SNAKEMAKE = $(RUN) -m bezierplan run
LOCKED    = --quiet --require-hashes --only-binary :all:
# Into the environment of an interpreter ($1), some packages ($2). uv takes a third of pip's time, but does not read pip's settings, which may name
# another index than PyPI.
pip       = $1 -m pip install --disable-pip-version-check $(LOCKED) $2
install   = $(RUN) -m uv pip install --python $1 $(LOCKED) $2 2>/dev/null || $(pip)
LOCK      = $(RUN) -m uv pip compile --quiet --universal --python-version 3.11 --fork-strategy fewest --generate-hashes

# A killed run leaves its lock behind. A clone has one user, so these targets may break it; plain `snakemake` keeps it.
UNLOCK = if [ -n "$$(ls .snakemake/locks 2>/dev/null)" ]; then $(SNAKEMAKE) --unlock >/dev/null 2>&1 || true; fi

# Byte code is kept, whatever the environment says: many containers say no, and then each of many processes compiles all modules anew.
unexport PYTHONDONTWRITEBYTECODE
# A copy of the tree runs its own source, whatever environment it has.
export PYTHONPATH = src

.PHONY: help reproduce smoke digests beyond extended test lint docs wheel image benchmark mutants compare archive cluster outcome lock newest clean distclean anew

help: ## list these targets
	@sed -n 's/^\([a-z-]*\):.*## \(.*\)/make \1|\2/p' Makefile | awk -F '|' '{ printf "%-19s %s\n", $$1, $$2 }'

reproduce: .venv/ready ## every table and figure of the papers, their claims, with as many runs as they used, into results/full
	@$(UNLOCK)
	$(SNAKEMAKE) all $(ARGS)

smoke: .venv/ready ## the same with few runs, into results/smoke
	@$(UNLOCK)
	$(SNAKEMAKE) smoke $(ARGS)

digests: .venv/ready ## keep the digests of scales smoke and full, and name those that change; the commit says why (ARGS: one of the scales)
	@$(UNLOCK)
	$(SNAKEMAKE) $(or $(subst full,all,$(ARGS)),smoke all)
	$(RUN) tests/digests.py $(ARGS)

beyond: .venv/ready ## what goes beyond the papers: variants, baselines, profiles, our own measures and maps; and the page with it
	@$(UNLOCK)
	$(SNAKEMAKE) beyond $(ARGS)
	$(SNAKEMAKE) all $(ARGS)

extended: .venv/ready ## both, with hundreds to thousands of runs per method, into results/extended
	@$(UNLOCK)
	$(SNAKEMAKE) extended $(ARGS)

test: .venv/ready-dev ## lint, the smoke subset, and the tests (with ALL=1 also those of clusters, archives and the like; ARGS go to pytest)
	@$(MAKE) --no-print-directory --jobs 2 $(if $(filter output-sync,$(.FEATURES)),--output-sync) ARGS= lint smoke
	$(RUN) -m pytest -n auto --dist loadfile $(if $(ALL),,-m "not rare") $(ARGS)

lint: .venv/ready-dev ## code style, import layers and types
	$(RUN) -m ruff check
	$(RUN) -m ruff format --check
	$(RUN) -m snakefmt --check Snakefile workflow
	.venv/bin/oxlint --quiet --deny-warnings src
	$(SNAKEMAKE) --lint
	$(RUN) .venv/bin/lint-imports --no-logo --cache-dir .cache/import-linter
	$(RUN) -m mypy

docs: .venv/ready-dev ## the documentation with the results as a site, into .cache/docs/html; without results, of scale smoke
	@ls results/*/index.html >/dev/null 2>&1 || $(SNAKEMAKE) smoke
	$(RUN) -m sphinx --fresh-env --quiet --fail-on-warning --builder html --doctree-dir .cache/docs/doctrees docs .cache/docs/html
	@echo 'Documentation: .cache/docs/html/index.html'

wheel: .venv/ready-dev ## a wheel for pip, into dist
	$(RUN) -m hatchling build --target wheel

image: ## an image for Docker with the workflow and its environment, named bezierplan
	docker build --tag bezierplan .

benchmark: .venv/ready ## what starts, kernels, planners, figures and the rest cost, compared with docs/benchmark.csv (ARGS: store, grown)
	@$(UNLOCK)
	$(SNAKEMAKE) smoke
	$(RUN) tests/benchmark/run.py $(ARGS)

mutants: .venv/ready-dev ## mutation tests: of faults that the commit draws, tests must catch nine in ten (ARGS: how many, a word of their files)
	$(RUN) tests/mutants.py $(ARGS)

compare: .cache/comparison/ready ## planners of all studies compared with OMPL's, into results/comparison
	cd $(<D) && bin/python '$(CURDIR)/tests/benchmark/compare_planners.py'

cluster: .venv/ready ## add Snakemake's plugins for Slurm and other schedulers, for profiles/slurm and profiles/cluster
	@$(call install,$(RUN),-r environment-cluster.txt)

archive: .cache/archive/ready ## results/full with code and environment as an RO-Crate, checked and zipped, into archive (ARGS: another scale)
	$(<D)/bin/python workflow/archive/archive.py $(ARGS)

outcome: .venv/ready ## everything at scales full and extended, then docs/outcome and the README's table
	@$(UNLOCK)
	$(SNAKEMAKE) all extended $(ARGS)
	$(RUN) docs/outcome.py

lock: .venv/ready ## regenerate the lock files from pyproject.toml (newest versions: ARGS=--upgrade)
	$(LOCK) $(ARGS) --extra workflow pyproject.toml -o environment.txt
	$(LOCK) $(ARGS) --group build -c environment.txt -o environment-build.txt
	$(LOCK) $(ARGS) --group dev -c environment.txt -o environment-dev.txt
	sed -i '/- pip:$$/q' workflow/envs/bezierplan.yaml
	$(RUN) -m uv pip compile --quiet --no-header --no-annotate --python-version 3.13 --extra workflow -c environment.txt pyproject.toml \
	  | sed 's/^/      - /' >> workflow/envs/bezierplan.yaml
	$(LOCK) $(ARGS) --group archive -o workflow/archive/requirements.txt
	$(LOCK) $(ARGS) --group cluster -c environment.txt -o environment-cluster.txt
	$(LOCK) $(ARGS) --group comparison -c environment.txt -o tests/benchmark/requirements.txt

newest: .venv/ready-dev ## check whether newer libraries change a result or fail a test (ARGS: other flags of `make lock`)
	$(RUN) tests/newest/run.py $(ARGS)

clean: ## remove results and caches
	rm -rf results/smoke results/full results/extended results/comparison results/benchmark.csv .snakemake .cache

distclean: clean ## remove the environment (.venv) as well
	rm -rf .venv

# What a shell reads in the double quotes that venv and pip put around paths.
unsafe = $(strip $(findstring $$,$(CURDIR)) $(findstring `,$(CURDIR)) $(findstring ",$(CURDIR)))

# Set-up. The file .venv/ready is written last, so that what an interrupted set-up left is made anew; so is an environment whose Python has gone.
fits  = import ensurepip, sys, venv; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))
found = $(firstword $(foreach p,$(PYTHON),$(shell $(p) -c '$(fits)' >/dev/null 2>&1 && echo $(p))))

imports = from bezierplan.running.jobs import forks; [*map(__import__, forks.FIRST + forks.LATER)]

.venv/ready: environment-build.txt environment.txt $(shell .venv/bin/python -c '' 2>/dev/null || echo anew)
	$(if $(unsafe),$(error bezierplan cannot be set up in $(CURDIR): programs of an environment read $(unsafe) in a path as a command; \
	  move the folder))
	$(if $(found),,$(error bezierplan needs Python 3.11 to 3.13 with venv. On Debian or Ubuntu: sudo apt install python3 python3-venv; \
	  elsewhere, or for another Python: make PYTHON=/path/to/python3))
	@echo "Setting up .venv with $(found): about 1 GB, up to a few minutes"
	@rm -rf .venv
	@$(found) -m venv .venv
	@$(call pip,$(RUN),-r environment-build.txt)
	@$(call install,$(RUN),--no-binary connection-pool --no-build-isolation -r environment.txt)
	@$(RUN) -c 'import sysconfig; open(sysconfig.get_path("purelib") + "/bezierplan.pth", "w").write("../../../../src\n")'
	@# What jobs import is compiled to byte code here, beside the first start, which takes a third less time.
	@$(RUN) -c '$(imports)' >/dev/null 2>&1 </dev/null &
	@touch $@

# What tests, linters and documentation need beside the workflow.
.venv/ready-dev: environment-dev.txt .venv/ready
	@echo "Adding to .venv what tests, linters and documentation need"
	@$(call install,$(RUN),-r environment-dev.txt)
	@touch $@

# Libraries to compare with and to archive with, apart from what the workflow runs on.
.cache/comparison/ready: tests/benchmark/requirements.txt
.cache/archive/ready: workflow/archive/requirements.txt
.cache/comparison/ready .cache/archive/ready: | .venv/ready
	@rm -rf $(@D)
	@$(RUN) -m venv $(@D)
	@$(call install,$(@D)/bin/python,-r $<) || \
	  { echo "$(@D): not every library of $< has a wheel that could be had for this platform; pip names it above" >&2; exit 1; }
	@touch $@
