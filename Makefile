# Every target that renders first makes sure that a Vulkan device exists
# (tools/setup.sh installs Mesa's lavapipe where there is none).

CARGO ?= cargo
OUT ?= out
# For each fuzz target.
FUZZ_SECONDS ?= 60
# Square pictures: resolution and samples per pixel.
DEMO_RESOLUTION ?= 320x320
DEMO_SPP ?= 48
# Which cases: all of them, which takes hours on two cores; nothing, for those of `make test`.
NUMERICS ?= --include-ignored
# Which study of the gallery: trees, hemisphere, shadows, parts, bounces, rates, roulette,
# adaptive; all by default, which takes about twenty minutes on two idle cores.
STUDY ?=
# Scenes, flags and page of the measurement of speed; about twelve minutes on two idle cores.
BENCH_SCENES ?= $(foreach name,cornell-box statue veach-mis environment many-lights,$(wildcard scenes/$(name)/$(name).gltf))
BENCH ?= --resolution 128x128 --spp 4,16,64 --max-bounces 7 --scene-time 70s \
	--ablation=1 --specialise=1 --startup --scale triangles,lights,pixels,bounces,threads \
	--most-triangles 100000 --most-lights 1000
SPEED ?= docs/speed.md
PYTHON ?= python3

.DEFAULT_GOAL := help
.PHONY: help setup demo test test-viewer test-report compare-study numerics gallery scenes bench fuzz kill-study test-slurm test-openjd lint fmt-check clean

help: ## List the targets
	@sed -n 's/^\([a-z-]*\):.*## /\1\t/p' Makefile | expand -t 12

setup: ## Install lavapipe if no Vulkan device is found
	@tools/setup.sh

demo: setup ## Render a bundled scene to out/demo.png
	@mkdir -p $(OUT)
	$(CARGO) run --release -- render scenes/statue/statue.gltf \
		-o $(OUT)/demo.png --resolution $(DEMO_RESOLUTION) --spp $(DEMO_SPP)

test: setup ## Run all tests, the window's among them
	$(CARGO) test
	tools/test_viewer.sh

test-viewer: setup ## Open the real window on a display of its own, drive it, look at its pixels
	tools/test_viewer.sh

test-slurm: setup ## Shards on Slurm, two nodes on this machine, one of them killed; as root
	$(CARGO) build --release
	tools/test_slurm.sh target/release/steradian

test-openjd: setup ## Shards by the Open Job Description template; needs openjd-cli
	$(CARGO) build --release
	tools/test_openjd.sh target/release/steradian

kill-study: setup ## Kill two renders 50 times each at random moments; they end with the same bytes
	$(CARGO) test --release --test cli fifty_kills -- --include-ignored --nocapture

test-report: setup ## Click through a report in headless Chromium; needs Node.js
	$(CARGO) build --release
	tools/test_report.sh target/release/steradian

compare-study: setup ## Measure anew what comparisons find, into docs/compare.md
	$(CARGO) run --release --example detection_power

numerics: setup ## Run the hard cases, long ones too, and write docs/numerics.md
	@mkdir -p $(OUT)
	@rm -f $(OUT)/figures.jsonl
	@status=0; STERADIAN_FIGURES=$(abspath $(OUT))/figures.jsonl \
		$(CARGO) test --release --no-fail-fast --test numerics --test known_radiance \
		-- $(NUMERICS) --test-threads 1 || status=$$?; \
	$(CARGO) run --release --example write_numerics -- \
		$(OUT)/figures.jsonl docs/numerics.md "$(NUMERICS)" && exit $$status

gallery: setup ## Write docs/gallery.md and its pictures; STUDY=name for one study
	$(CARGO) build --release --bins --examples
	target/release/examples/make_gallery $(STUDY)

scenes: ## Write the bundled scenes anew from their description
	$(CARGO) run --release --example make_scenes

bench: setup ## Measure speed against error into docs/speed.md, beside Mitsuba 3 if that is installed
	$(CARGO) build --release
	@rival='--against mitsuba'; \
	if ! $(PYTHON) -c 'import mitsuba' 2>/dev/null; then \
		echo 'bench: without Mitsuba 3, our own curves only: $(PYTHON) -m pip install mitsuba' >&2; \
		rival=; \
	fi; \
	mkdir -p $(OUT); \
	target/release/steradian bench $(BENCH_SCENES) $(BENCH) $$rival --python $(PYTHON) \
		--markdown $(SPEED) --report $(OUT)/speed.html --json $(OUT)/speed.json >/dev/null

fuzz: ## Feed the loader with random files, a minute for each target; FUZZ_SECONDS=n
	tools/fuzz.sh $(FUZZ_SECONDS)

fmt-check: ## Check the formatting
	$(CARGO) fmt --check

lint: fmt-check ## Formatting and clippy, warnings are errors
	$(CARGO) clippy --all-targets -- -D warnings

clean: ## Remove pictures; `cargo clean` removes the build
	rm -rf $(OUT)
