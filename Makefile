# The two commands to know: `make demo` and `make test`. Everything they need, they install.

.PHONY: help demo demo-nodes test test-page build deps python wheel deb docs gallery bench lint format sanitize tsan fuzz soak sbom reproducible clean bench-gl

help:
	@echo "make demo      remove the objects of the bundled recordings, print the figures"
	@echo "make demo-nodes  the workbench's cameras as programs of their own, on a web page"
	@echo "make test      build and run all tests"
	@echo "make test-page test the web page in a browser"
	@echo "make build     build the program: build/release/diminish"
	@echo "make python    build the Python module: build/release/python"
	@echo "make wheel     pack it for pip: dist/diminish-....whl"
	@echo "make deb       Debian packages: dist/*.deb"
	@echo "make docs      the docs as a site: build/site/index.html"
	@echo "make gallery   all view modes on all recordings, on one page"
	@echo "make bench     measure each stage beside its peer"
	@echo "make bench-gl  measure what runs on the GPU"
	@echo "make lint      clang-format and clang-tidy"
	@echo "make sanitize  all tests under the address and undefined-behaviour sanitizers"
	@echo "make tsan      all tests under the thread sanitizer"
	@echo "make fuzz      fuzz what reads what comes from outside, a minute each"
	@echo "make soak      hours of frames, and of all faults at once"
	@echo "make sbom      what the program is made of: build/release/sbom.json (CycloneDX)"
	@echo "make reproducible  two builds in two folders, whose bytes must be the same"

deps:
	@scripts/install-deps

build:
	@scripts/install-deps program
	scripts/build "" diminish_program

demo: build
	scripts/demo

demo-nodes: build
	scripts/demo-nodes

test: deps
	scripts/build
	scripts/test

test-page: deps build
	scripts/install-deps page
	scripts/test-page

python: deps
	scripts/build "" diminish_python

wheel: python
	/usr/bin/python3 python/build_backend.py build/release dist

deb: deps
	scripts/deb

docs:
	scripts/install-deps docs
	/usr/bin/python3 scripts/docs

gallery: build
	scripts/gallery

bench: deps
	scripts/bench

bench-gl: deps
	scripts/bench --gl

lint: deps
	scripts/lint

format:
	scripts/format

sanitize: deps
	scripts/sanitize

tsan: deps
	scripts/sanitize tsan

fuzz: deps
	scripts/fuzz

soak: deps
	scripts/soak

sbom: build
	scripts/build "" diminish
	scripts/sbom build/release > build/release/sbom.json

reproducible: deps
	scripts/reproduce

clean:
	rm -rf build demo/out
