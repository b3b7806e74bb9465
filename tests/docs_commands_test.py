"""Holds the docs to what is there: every command in them has its flags, those that are quick run, links lead somewhere.

    docs_commands_test.py PROGRAM

Commands are the lines of indented and of shell blocks. Words in capitals stand for folders of the reader's: they become
copies of the bundled recordings and folders for results. What needs cameras, minutes or the reader's own files is held to
its flags, make targets and scripts to being there.
"""

import functools
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = os.path.abspath(sys.argv.pop(1))
ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = sorted([*ROOT.glob("*.md"), *(ROOT / "docs").glob("*.md")])
QUICK = {"run", "scan", "score", "report", "compare", "markers", "devices", "train-color", "repair", "check", "help"}
CAMERA = re.compile(r"v4l2:|openni2:|gstreamer:|CAMERA|\.\.\.|[\[\]]")
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def blocks(page):
    """The page's blocks of commands: [(line number, text), ...] each."""
    found, block, fence = [], [], None
    for number, line in enumerate([*page.read_text().splitlines(), ""], 1):
        if line.startswith("```"):
            fence = line[3:] if fence is None else None
        is_command = fence == "sh" or (fence is None and line.startswith("    ") and line.strip())
        if is_command and not line.startswith("```"):
            # "command   # what for", "command      what for"
            block.append((number, re.split(r"\s+# |\s{3,}", line.strip())[0].replace("build/release/diminish", "diminish")))
        elif block:
            found.append(block)
            block = []
    return found


@functools.lru_cache(None)
def help_of(command):
    done = subprocess.run([PROGRAM, *command, "--help"], capture_output=True, text=True)
    return done.stdout if done.returncode == 0 else None


def commands_below(command):
    return re.findall(r"^  (\S+) ", help_of(command).partition("Subcommands:\n")[2], re.M)


def split_command(words):
    """("calibrate", "rig") and the rest"""
    command = ()
    while len(command) < len(words) and words[len(command)] in commands_below(command):
        command += (words[len(command)],)
    return command, words[len(command) :]


def anchors(page):
    """As GitHub and mkdocs make them of headings."""
    made = set()
    for heading in re.findall(r"^#+ (.*)$", page.read_text(), re.M):
        plain = re.sub(r"[^\w\- ]", "", heading.lower())
        made.add(plain.replace(" ", "-"))
    return made


class DocsTest(unittest.TestCase):
    def test_links_lead_somewhere(self):
        checked = 0
        for page in PAGES:
            for link in LINK.findall(re.sub(r"```.*?```", "", page.read_text(), flags=re.S)):
                if re.match(r"\w+:", link):
                    continue
                path, _, anchor = link.partition("#")
                target = (page.parent / path).resolve() if path else page
                self.assertTrue(target.exists(), f"{page.name}: {link}")
                if anchor and target.suffix == ".md":
                    self.assertIn(anchor, anchors(target), f"{page.name}: {link}")
                checked += 1
        self.assertGreater(checked, 100)

    def test_every_page_is_in_the_site_s_menu(self):
        menu = (ROOT / "mkdocs.yml").read_text()
        for page in (ROOT / "docs").glob("*.md"):
            self.assertRegex(menu, rf"(?m)[ -]{re.escape(page.name)}$", "expected a place in the menu of mkdocs.yml")

    def test_pages_are_short(self):
        for page in PAGES:
            if page.name != "CHANGELOG.md":
                self.assertLessEqual(len(page.read_text().split()), 1500, f"{page.name}: split it by what a reader asks")

    def test_make_targets_and_scripts_are_there(self):
        targets = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(), re.M))
        for page in PAGES:
            text = page.read_text()
            for target in re.findall(r"(?:^    |`)make ([\w-]+)", text, re.M):
                self.assertIn(target, targets, page.name)
            for script in re.findall(r"(?:^    |`)(scripts/[\w-]+)", text, re.M):
                self.assertTrue(os.access(ROOT / script, os.X_OK), f"{page.name}: {script}")

    def test_commands_have_their_flags(self):
        checked = 0
        for page in PAGES:
            inline = [(0, code) for code in re.findall(r"`(diminish [a-z][^`]*)`", page.read_text())]
            for number, line in [*inline, *(line for block in blocks(page) for line in block)]:
                if not re.match(r"diminish [a-z-]+( |$)", line):
                    continue
                place = f"{page.name}:{number}: {line}"
                command, _ = split_command(line.split()[1:])
                self.assertTrue(command, place)
                for flag in re.findall(r"(?<=[\s\[])(--[\w-]+)", line):
                    self.assertRegex(help_of(command), rf"(?m)^  .*{re.escape(flag)}[ ,{{=]", place)
                checked += 1
        self.assertGreater(checked, 50)

    def test_quick_commands_run(self):
        done = set()
        self.seen = set()
        for page in PAGES:
            for block in blocks(page):
                lines = [line for line in block if re.match(r"diminish [a-z-]+( |$)", line[1])]
                if lines:
                    done |= self.run_block(page, lines)
        self.assertLessEqual(QUICK - {"help"}, done)

    def run_block(self, page, lines):
        """Runs a block's commands in a folder with the recordings. Returns which."""
        done = set()
        with tempfile.TemporaryDirectory() as top:
            folder = pathlib.Path(top)
            (folder / "demo").symlink_to(ROOT / "demo")
            for name in ("RECORDING", "OTHER"):
                shutil.copytree(ROOT / "demo/recordings/arm", folder / name)
            first = [PROGRAM, "run", "RECORDING", "--out"]
            for number, line in lines:
                words = [word.replace("/tmp/", f"{top}/") for word in shlex.split(line)[1:]]
                command, arguments = split_command(words)
                if command[0] not in QUICK or CAMERA.search(line) or line in self.seen:
                    continue
                if command[0] == "train-color":  # an object of one colour
                    shutil.copytree(ROOT / "demo/recordings/ball", folder / "BALL")
                    arguments = ["BALL" if word == "RECORDING" else word for word in arguments]
                outputs = [arguments[i + 1] for i, word in enumerate(arguments[:-1]) if word == "--out"]
                inputs = [word for word in arguments if "/" in word or word.isupper()]
                for word in inputs:
                    # Results of a command that the reader has run before
                    if word in ("DIR", "OUT") and word not in outputs and not (folder / word).exists():
                        subprocess.run([*first, word], cwd=folder, check=True, capture_output=True)
                    if word == "ROOM" and word not in outputs and not (folder / word).exists():
                        subprocess.run([PROGRAM, "scan", "RECORDING", "--out", word], cwd=folder, check=True, capture_output=True)
                if any(word not in outputs and not (folder / word).exists() for word in inputs if word != "FILE"):
                    continue
                if arguments and arguments[0] in ("my-desk", "waved"):
                    continue
                if "--out" in arguments and "FILE" in arguments:
                    arguments[arguments.index("FILE")] = "out.pdf"
                more = ["--force"] if command[0] == "run" and "--force" not in arguments else []
                ran = subprocess.run([PROGRAM, *command, *arguments, *more], cwd=folder, capture_output=True, text=True)
                self.assertIn(ran.returncode, (0, 3), f"{page.name}:{number}: {line}\n{ran.stderr}")
                done.add(command[0])
                self.seen.add(line)
        return done


class Version(unittest.TestCase):
    def test_is_cited_as_built(self):
        cited = re.search(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(), re.M)[1]
        built = subprocess.run([PROGRAM, "--version"], check=True, capture_output=True, text=True).stdout.strip()
        self.assertEqual(cited, built)


if __name__ == "__main__":
    unittest.main()
