"""Makes the wheel, for `pip install .` and `make wheel` (PEP 517). It needs CMake, Ninja, a compiler and
the library's own packages (scripts/install-deps), and nothing from PyPI.

    pip install .                                              builds in build/wheel-..., then installs
    pip install --config-settings build-dir=build/release .    packs a build that is there
    python3 python/build_backend.py BUILD_FOLDER OUT           the same, without pip

The wheel has the module, the library and the stubs. What the library itself is linked with (OpenCV, TBB,
FFmpeg, ...) is the system's: it is for the distribution that it was made on.
"""

import base64
import hashlib
import pathlib
import re
import subprocess
import sys
import sysconfig
import tarfile
import zipfile

try:
    import tomllib
except ImportError:  # before Python 3.11
    import tomli as tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
FIRST_MOMENT = (1980, 1, 1, 0, 0, 0)  # of a zip file: the same build gives the same bytes


def version():
    return re.search(r"project\(diminish VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())[1]


def interpreter_tag():
    return f"cp{sys.version_info.major}{sys.version_info.minor}"


def wheel_tag():
    platform = re.sub(r"[-.]", "_", sysconfig.get_platform())
    return f"{interpreter_tag()}-{interpreter_tag()}-{platform}"


def build():
    folder = ROOT / "build" / f"wheel-{interpreter_tag()}"
    subprocess.run(
        ["cmake", "-S", ROOT, "-B", folder, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release",
         "-DDIMINISH_BUILD_TESTS=OFF", f"-DPython3_EXECUTABLE={sys.executable}"],
        check=True,
    )
    subprocess.run(["cmake", "--build", folder, "--target", "diminish_python"], check=True)
    return folder


def metadata():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    lines = [
        "Metadata-Version: 2.1",
        f"Name: {project['name']}",
        f"Version: {version()}",
        f"Summary: {project['description']}",
        f"License: {project['license']['text']}",
        f"Requires-Python: {project['requires-python']}",
        *(f"Requires-Dist: {name}" for name in project["dependencies"]),
        "Description-Content-Type: text/markdown",
        "",
        (ROOT / project["readme"]).read_text(),
    ]
    return "\n".join(lines)


def contents(folder):
    """What a build gives the wheel: bytes by path."""
    module = folder / "python" / ("diminish" + sysconfig.get_config_var("EXT_SUFFIX"))
    if not module.exists():
        raise SystemExit(f"{module}: expected the module for this Python; build the target diminish_python")
    library = (folder / "libdiminish.so").resolve()
    soname = re.search(r"libdiminish\.so\.\d+", library.name)[0]
    info = f"diminish-{version()}.dist-info/"
    return {
        module.name: module.read_bytes(),
        "diminish.libs/" + soname: library.read_bytes(),
        "diminish-stubs/__init__.pyi": (ROOT / "python" / "diminish.pyi").read_bytes(),
        info + "LICENSE": (ROOT / "LICENSE").read_bytes(),
        info + "METADATA": metadata().encode(),
        info + "WHEEL": f"Wheel-Version: 1.0\nGenerator: diminish {version()}\nRoot-Is-Purelib: false\n"
        f"Tag: {wheel_tag()}\n".encode(),
    }


def digest(data):
    return "sha256=" + base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()


def pack(folder, out):
    """Writes the wheel into the folder `out`. Returns its name."""
    files = contents(pathlib.Path(folder))
    record = f"diminish-{version()}.dist-info/RECORD"
    rows = [f"{path},{digest(data)},{len(data)}" for path, data in files.items()]
    files[record] = "\n".join([*rows, f"{record},,", ""]).encode()
    name = f"diminish-{version()}-{wheel_tag()}.whl"
    with zipfile.ZipFile(pathlib.Path(out) / name, "w", zipfile.ZIP_DEFLATED) as wheel:
        for path, data in files.items():
            entry = zipfile.ZipInfo(path, FIRST_MOMENT)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (0o755 if ".so" in path else 0o644) << 16
            wheel.writestr(entry, data)
    return name


# What pip calls.
def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    folder = (config_settings or {}).get("build-dir")
    return pack(ROOT / folder if folder else build(), wheel_directory)


def build_sdist(sdist_directory, config_settings=None):
    name = f"diminish-{version()}"
    listed = subprocess.run(["git", "ls-files", "-z"], cwd=ROOT, check=True, capture_output=True).stdout
    with tarfile.open(pathlib.Path(sdist_directory) / f"{name}.tar.gz", "w:gz") as archive:
        for path in listed.decode().split("\0")[:-1]:
            archive.add(ROOT / path, f"{name}/{path}", recursive=False)
    return f"{name}.tar.gz"


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    pathlib.Path(sys.argv[2]).mkdir(parents=True, exist_ok=True)
    print(pathlib.Path(sys.argv[2]) / pack(sys.argv[1], sys.argv[2]))
