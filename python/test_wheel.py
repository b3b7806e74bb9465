"""Installs the module into a fresh virtual environment with pip, without a network, and runs its tests there.

    test_wheel.py BUILD_FOLDER RECORDINGS
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import venv
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
build, recordings = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])


def run(*command, **more):
    environment = {name: value for name, value in os.environ.items() if name not in ("PYTHONPATH", "LD_LIBRARY_PATH")}
    environment["DIMINISH_RECORDINGS"] = str(recordings)
    return subprocess.run(command, check=True, env=environment, text=True, **more)


with tempfile.TemporaryDirectory() as top:
    folder = pathlib.Path(top)
    venv.create(folder / "venv", system_site_packages=True, with_pip=True)
    python = folder / "venv/bin/python"
    pip = (python, "-m", "pip", "--quiet", "--disable-pip-version-check")

    # The same build gives the same bytes, with pip or without.
    run(*pip, "wheel", "--no-index", "--no-deps", "--wheel-dir", folder / "a", "--config-settings", f"build-dir={build}", HERE.parent)
    run(python, HERE / "build_backend.py", build, folder / "b")
    (wheel,) = (folder / "a").iterdir()
    assert wheel.read_bytes() == (folder / "b" / wheel.name).read_bytes(), wheel.name
    assert "diminish-stubs/__init__.pyi" in zipfile.ZipFile(wheel).namelist()

    run(*pip, "install", "--no-index", "--no-deps", wheel)
    known = "import importlib.metadata as m; print(m.version('diminish'), m.requires('diminish'))"
    assert run(python, "-c", known, stdout=subprocess.PIPE).stdout.split() == [wheel.name.split("-")[1], "['numpy']"]
    loaded = run(
        python, "-c", "import diminish; print(diminish.__file__); print(open('/proc/self/maps').read())",
        cwd=folder, stdout=subprocess.PIPE,
    ).stdout
    assert loaded.startswith(str(folder / "venv")), loaded.splitlines()[0]
    libraries = {line.split()[-1] for line in loaded.splitlines() if "libdiminish" in line}
    assert libraries and all(name.startswith(str(folder / "venv")) for name in libraries), libraries
    run(python, HERE / "test_diminish.py", "StubsTest", "OptionsTest", "PicturesTest",
        "PipelineTest.test_own_images_give_the_same_bytes", cwd=folder)
    run(*pip, "uninstall", "--yes", "diminish")
    left = [path for path in (folder / "venv").rglob("*diminish*")]
    assert not left, left
