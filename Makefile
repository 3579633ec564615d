# `make run` and `make test` set up what a fresh machine lacks. `make help` lists the rest.
PORT ?= 8000
ONLY ?=
COMPARE ?=
LONG ?=
FUZZ_SECONDS ?= 600
KILLS ?= 100
MISSIONS ?= 1000
FAULTS ?= 100
CHAOS_SECONDS ?= 3600
CUTS ?= 10000
QUESTIONS ?= 300
WORDS ?= 500
HOURS ?= 8
PYTHON := .venv/bin/python
# Debian's own comes before one that was built here: robots have it, too, and it is faster than most others.
SYSTEM_PYTHON := $(firstword $(wildcard /usr/bin/python3) python3)
# Where it is set, each process compiles at every start what it imports: pytest its tests, at 8 seconds a time.
unexport PYTHONDONTWRITEBYTECODE
# Compiled once, also for a robot that is started without make.
INSTALL := --quiet --python $(PYTHON) --constraint constraints.txt --compile-bytecode
CPPCHECK := cppcheck --quiet --error-exitcode=1 --enable=warning,portability --inline-suppr -DMUCAT_BAUD=250000 -Ifirmware/src -Ifirmware/emulator
PAGE_SOURCES := $(shell find frontend/src frontend/index.html frontend/public -type f 2>/dev/null) \
	$(wildcard frontend/*.ts frontend/*.js frontend/*.json)
HELP_SOURCES := $(shell find docs -type f)
# Tests in real time that mostly wait, for uploads, downloads, a slow network or a look at every page, and bear a delay.
WAITING := $(addprefix tests/,board/test_bootloader.py packages/test_32_bits.py packages/test_wheels.py \
	$(addprefix runtime/experiments/comm_test/,test_reset_pin.py test_robot_lab.py test_upload.py) \
	server/http/test_poor_network.py \
	server/features/board/test_firmware_upload.py server/features/bring_up/test_on_the_robot.py \
	server/features/comm_tests/test_reserved_board.py server/features/comm_tests/test_thesis_example.py \
	$(addprefix browser/,test_accessible.py test_bring_up.py test_compare.py test_firmware_upload.py))
REAL_TIME = $(filter-out $(WAITING),$(shell grep -rl --include='test_*.py' mark.stack tests | sort))
# All other tests, each part by a process of its own, the longest first, also those that mostly wait; those of pages once a
# robot in real time has little left to do. A part lacks what is a part by itself.
PARTS := $(addprefix tests/,runtime/experiments proofs server pages proofs/test_guards.py server/features \
	proofs/test_memory.py server/features/doors) tests $(addprefix tests/,runtime documents server/features/exports \
	server/features/comparison server/features/identification)

# With a number of jobs of its own, not what another make leaves over. A failure does not hide those of what comes after it.
IN_LANES = env MAKEFLAGS= $(MAKE) --no-print-directory --keep-going --output-sync=line
BESIDE := nice $(SYSTEM_PYTHON) -m tests.beside

.DEFAULT_GOAL := help
.PHONY: help run test services debian test-real-time test-waiting test-checks test-page test-rest $(PARTS:%=test-in-%) check check-code bench figures control screenshots fuzz soak samples kills faults robot-faults outages chaos power guards hostile interface attacks lab-proof hours generate firmware wheels all-wheels packages release missions notebooks image image-swims \
	host-firmware released-session setup setup-test clean

help: ## list the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | sed 's/:.*## /\t/' | expand -t 12

run: setup ## start everything; the page is at http://localhost:8000 (PORT=8123 for another port)
	@exec .venv/bin/mucat run --port $(PORT)

test: build/.packages-test ## every check and every test, in lanes; the output of a lane comes when a command of it has ended, and the time in the last line
	@$(SYSTEM_PYTHON) -m tests.timed $(IN_LANES) --jobs 6 test-real-time test-waiting test-checks test-rest test-page

# The page's checks need little: they run while packages are downloaded.
test-real-time test-waiting test-checks test-rest: setup-test host-firmware

# Robots in real time have the processors first, one at a time: with two of them, both are late.
test-real-time:
	@status=0; \
	$(PYTHON) -m pytest -m stack --durations 20 $(REAL_TIME) || status=1; \
	$(PYTHON) -m pytest --durations 20 tests/browser $(addprefix --ignore=,$(filter tests/browser/%,$(WAITING))) || status=1; \
	exit $$status

test-waiting:
	@nice -n 5 $(PYTHON) -m pytest -m stack --durations 10 $(WAITING)

test-checks:
	@$(BESIDE) $(IN_LANES) check-code

test-page: frontend/node_modules/.ready
	@status=0; \
	$(BESIDE) npm --prefix frontend run --silent style || status=1; \
	$(BESIDE) npm --prefix frontend test --silent || status=1; \
	exit $$status

# Three at once, since many of them wait for a process; four are no quicker.
test-rest:
	@$(BESIDE) $(IN_LANES) --jobs 3 $(PARTS:%=test-in-%)

$(PARTS:%=test-in-%): test-in-%:
	@$(PYTHON) -m pytest -m "not stack" --durations 10 $* $(addprefix --ignore=,$(filter $*/%,$(PARTS) tests/browser))

check: check-code ## style, types, imports, faults of C and C++, and whether generated files are current
	cd frontend && npm run --silent check

check-code: setup-test
	.venv/bin/ruff check
	.venv/bin/ruff format --check
	.venv/bin/mypy
	.venv/bin/lint-imports
	$(PYTHON) -m robot_runtime.generate --check
	$(PYTHON) -m tests.checks
	$(PYTHON) -m server.openapi | (cd frontend && npm run --silent generate:check)
	$(PYTHON) -m server.openapi --reference --check
	clang-format --dry-run -Werror $$(git ls-files 'firmware/*.h' 'firmware/*.c' 'firmware/*.cpp' 'firmware/*.ino' ':!firmware/*.gen.h')
	$(CPPCHECK) --std=c++11 --language=c++ -D__AVR__ '-DISR(vector)=void vector()' $$(git ls-files 'firmware/src/*.cpp' 'firmware/hil/*.cpp' 'firmware/examples/*.ino')
	$(CPPCHECK) $$(git ls-files 'firmware/emulator/*.c' 'firmware/emulator/*.cpp' 'firmware/host/board.cpp' 'firmware/host/interface.cpp')

guards: setup-test ## take away every guard in turn: a test must miss it (some with ONLY=words of their names)
	@nice $(PYTHON) -m tests.proofs.guards $(ONLY)

hostile: setup ## hostile words through every entrance to a build, a file name or a path (WORDS=500 each)
	@nice $(PYTHON) -W ignore -m tests.proofs.hostile $(WORDS)

interface: setup ## ask every operation what its description lets one think of (QUESTIONS=300 of each)
	@nice $(PYTHON) -W ignore -m tests.proofs.interface $(QUESTIONS)

attacks: setup host-firmware ## every attack of the security review on a whole robot, while an operator arms it and presses STOP (some with ONLY=words)
	@nice $(PYTHON) -m tests.proofs.attacks $(ONLY)

hours: setup host-firmware ## record HOURS=8 of a dive in simulated time and read them; an hour's load on the memory
	@nice $(PYTHON) -m tests.proofs.hours $(HOURS)
	@nice $(PYTHON) -m tests.proofs.memory 60

released-session: setup host-firmware ## store a session of this version, which every later one must read; once a release
	$(PYTHON) -m tests.released

generate: .venv/.ready frontend/node_modules/.ready ## write the generated files from their definitions
	$(PYTHON) -m robot_runtime.generate
	$(PYTHON) -m server.openapi | (cd frontend && npm run --silent generate)
	$(PYTHON) -m server.openapi --reference
	$(PYTHON) -m tests.proofs.page

bench: setup-test .venv/.ready-bench host-firmware ## measure; a part with ONLY=link; against another commit with COMPARE=v0.1.0
	$(PYTHON) -m bench$(if $(COMPARE),.against $(COMPARE))$(if $(LONG), --long) $(ONLY)

proofs: setup-test .venv/.ready-bench host-firmware ## every long proof, with one report in build/proofs and the results in docs/develop/proofs.md; goes on where it stopped
	@$(PYTHON) -m tests.proofs.report $(ONLY)

figures: setup-test host-firmware ## remake the thesis's Figures 14 to 16 in docs/pictures, from a run of its scenario
	@rm -rf build/figures
	.venv/bin/mucat scenario run figure_14 --data build/figures
	$(PYTHON) -m bench.figures 1 --data build/figures

notebooks: setup-test host-firmware ## run the notebooks of docs/use/notebooks, and write their pages and figures
	$(PYTHON) -W ignore -m tests.notebooks

screenshots: setup-test host-firmware ## take the manual's pictures and the film anew, into docs (some with ONLY="operate film")
	$(PYTHON) -W ignore -m tests.pictures $(ONLY)

lab-proof: setup-test host-firmware ## a whole lab in network namespaces while its parts fail: cut cables, kills, wrong certificates, a full disk (needs root)
	@$(PYTHON) -W ignore -m tests.proofs.lab

control: setup-test host-firmware ## remake the tables of docs/develop/controllers.md; those of heading, pitch and roll are printed
	$(PYTHON) -m bench.control
	$(PYTHON) -m bench.turns

samples: setup ## run the thesis's grid again, for the runs that ship (five times a few minutes)
	$(PYTHON) -m bench.samples

packages: setup-test all-wheels ## install the wheels into fresh systems of four architectures and swim there (needs root; some with ONLY=names)
	@nice $(PYTHON) -m tests.proofs.packages $(ONLY)

fuzz: setup-test ## fuzz the firmware's end of the line for FUZZ_SECONDS=600, on from what earlier runs found
	@nice $(PYTHON) -m tests.proofs.fuzz $(FUZZ_SECONDS)

soak: setup-test ## prove the link at length: corrupted frames by the million, a thousand resets
	@nice $(PYTHON) -m tests.proofs

services: setup-test build/.packages-packages ## install, update and roll back on computers with systemd, and cut their power (needs root; one with ONLY=name)
	@nice $(PYTHON) -m tests.proofs.services $(ONLY)

debian: setup-test build/.packages-packages ## install, update, roll back and purge the Debian package on a computer with systemd (needs root)
	@nice $(PYTHON) -m tests.proofs.debian

kills: setup ## kill the server a hundred times while it records, and look for holes (KILLS=100)
	@nice $(PYTHON) -m tests.proofs.kills $(KILLS)

power: setup-test ## cut the power ten thousand times while the server stores, and look for losses (CUTS=10000)
	@nice $(PYTHON) -m tests.proofs.power $(CUTS)

faults: setup-test host-firmware ## inject every fault a hundred times, and measure how soon the fins stop (FAULTS=100)
	@nice $(PYTHON) -m tests.proofs.injections $(FAULTS)

robot-faults: setup-test host-firmware ## of these, the faults of robot and chip, in simulated time (some with ONLY=words of their names)
	@nice $(PYTHON) -m tests.proofs.injections $(FAULTS) robot $(ONLY)

outages: setup-test ## of these, the processes that are killed or hang, in real time, two robots at once
	@$(PYTHON) -m tests.proofs.injections $(FAULTS) processes

missions: setup-test host-firmware ## end each leaf of a mission in each way, compare lanes by dead reckoning with the truth, and swim a thousand random missions (MISSIONS=1000)
	@nice $(PYTHON) -W ignore -m tests.proofs.missions $(MISSIONS)

chaos: setup ## an hour of kills, noise, stalled viewers and a full disk while it records (CHAOS_SECONDS=3600)
	@nice $(PYTHON) -m tests.proofs.chaos $(CHAOS_SECONDS)

firmware: build/.packages-run .venv/.ready ## compile the firmware for the baud of robot.toml, the boot loader and the emulated board
	@$(MAKE) --silent -C firmware --question robot 2>/dev/null || echo "The firmware ..."
	@$(MAKE) --silent -C firmware robot
	@$(PYTHON) -m robot_runtime.simulation.boards.firmware
	@$(MAKE) --silent -C firmware/bootloader
	@$(MAKE) --silent -C firmware/emulator --question 2>/dev/null || echo "The emulated board ..."
	@$(MAKE) --silent -C firmware/emulator

# After the robot's firmware, of which it needs objects, too. What robots in real time run is not left to a build of
# little weight, for which they would wait.
host-firmware: firmware
	@$(MAKE) --silent -C firmware host hang full proofs
	@$(MAKE) --silent -C firmware HIL=1 robot > /dev/null

setup: build/.packages-run .venv/.ready server/page/index.html server/help/index.html firmware

setup-test: build/.packages-test setup tests/clients/node_modules/.ready

# Two at once would wait for each other's apt.
build/.packages-test: build/.packages-run
build/.packages-packages: build/.packages-run

build/.packages-%: setup.sh
	@./setup.sh $* $(SYSTEM_PYTHON)
	@mkdir -p build && touch $@

.venv/.ready: pyproject.toml constraints.txt | build/.packages-run
	@echo "Python packages ..."
	@$(SYSTEM_PYTHON) -m venv --clear .venv
	@$(PYTHON) -m pip install --quiet --disable-pip-version-check "$$(grep ^uv== constraints.txt)"
	@.venv/bin/uv pip install $(INSTALL) --editable . --group dev --group help
	@.venv/bin/uv pip install $(INSTALL) --no-build mujoco || \
		echo "MuJoCo could not be installed; instead of rendered water the camera shows a drawn card."
	@$(PYTHON) -m compileall -q robot_runtime server migrations
	@touch $@

.venv/.ready-bench: .venv/.ready
	@.venv/bin/uv pip install $(INSTALL) --group bench
	@touch $@

frontend/node_modules/.ready: frontend/package.json frontend/package-lock.json | build/.packages-run
	@echo "Packages of the page ..."
	@cd frontend && npm ci --no-audit --no-fund --loglevel=error
	@touch $@

tests/clients/node_modules/.ready: tests/clients/package.json tests/clients/package-lock.json | build/.packages-run
	@echo "Other people's clients, for tests ..."
	@cd tests/clients && npm ci --no-audit --no-fund --loglevel=error
	@touch $@

server/page/index.html: frontend/node_modules/.ready $(PAGE_SOURCES)
	@echo "The page ..."
	@cd frontend && npm run --silent build
	@touch $@

# Source maps and languages of the search that nobody asks for would be most of the site.
server/help/index.html: .venv/.ready mkdocs.yml $(HELP_SOURCES)
	@echo "The help ..."
	@NO_MKDOCS_2_WARNING=1 .venv/bin/mkdocs build --quiet --strict
	@rm -r server/help/assets/javascripts/lunr && find server/help -name '*.map' -delete
	@touch $@

wheels: setup ## build the wheels into dist/, with the emulated board for this computer
	@$(PYTHON) -m packages.wheels

all-wheels: build/.packages-packages setup ## the same with the emulated board for every architecture
	@$(PYTHON) -m packages.wheels x86_64 aarch64 i686

release: setup ## build a signed release into dist/: make release KEY=~/release-key.pem (MACHINE=aarch64 PYTHON_OF=3.13, LAB=1 for a lab; as root for this computer the container image, too)
	@test -n "$(KEY)" || { echo "Name the secret key, which is made where there is none: make release KEY=FILE"; exit 1; }
	@$(PYTHON) -m packages.release $(KEY) $(addprefix --machine ,$(MACHINE)) $(addprefix --python ,$(PYTHON_OF)) $(if $(LAB),--lab)
	$(if $(MACHINE)$(LAB),,@test "$$(id -u)" -ne 0 || $(MAKE) --no-print-directory image KEY=$(KEY))

image: setup build/.packages-packages ## build the container image of the emulated robot and the lab into dist/ (needs root): make image KEY=FILE
	@test -n "$(KEY)" || { echo "Name the secret key, which is made where there is none: make image KEY=FILE"; exit 1; }
	@$(PYTHON) -m packages.image $(KEY)

image-swims: setup build/.packages-packages ## build the image, arm its robot, and serve a lab with PostgreSQL (needs root)
	@nice $(PYTHON) -m tests.proofs.image

clean: ## remove everything that was built
	rm -rf build dist .venv frontend/node_modules tests/clients/node_modules server/page server/help
