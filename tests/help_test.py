"""Man pages and completion say what --help says, which CLI11 writes itself.

    help_test.py PROGRAM
"""

import functools
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = sys.argv.pop(1)


def run(*arguments, **more):
    done = subprocess.run(arguments, capture_output=True, text=True, **more)
    if done.returncode != 0:
        raise AssertionError(f"{arguments}: {done.returncode}\n{done.stderr}")
    return done.stdout


@functools.lru_cache(None)
def help_of(*command):
    return run(PROGRAM, *command, "--help")


def below(command):
    """The commands that --help lists below this one, such as ["calibrate"]."""
    listed = help_of(*command).partition("Subcommands:\n")[2]
    return [[*command, name] for name in re.findall(r"^  (\S+) ", listed, re.M)]


def all_commands(command=()):
    commands = [list(command)]
    for child in below(list(command)):
        commands += all_commands(child)
    return commands


COMMANDS = all_commands()


def flags(command):
    found = set()
    for line in help_of(*command).splitlines():
        # "  -h,--help    ..." "  --a,--no-a{false}   ..." "  --b=0.5   ..."
        named = re.match(r"  (-\S+)", line)
        if named:
            found |= {re.sub(r"[{=].*", "", name) for name in named[1].split(",")}
    return found


def completions(script, lines):
    """What bash offers for each of these lines, whose last word is being written."""
    calls = "compopt() { :; }\n" + script
    for words in lines:
        quoted = " ".join(f"'{word}'" for word in words)
        calls += f"\nCOMP_WORDS=({quoted}); COMP_CWORD={len(words) - 1}; _diminish; echo \"${{COMPREPLY[*]}}\""
    output = run("bash", "-c", calls).splitlines()
    return [set(line.split()) for line in output]


class HelpTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        with tempfile.TemporaryDirectory() as top:
            run(PROGRAM, "help", "--write-to", top)
            written = {path.relative_to(top).as_posix(): path.read_text() for path in pathlib.Path(top).rglob("*.*")}
            cls.pages = {name: text for name, text in written.items() if name.startswith("man/")}
            cls.bash = (pathlib.Path(top) / "completion/diminish").read_text()
            cls.zsh = (pathlib.Path(top) / "completion/_diminish").read_text()
            cls.fish = written["completion/diminish.fish"]

    def page(self, command):
        return self.pages["man/" + "-".join(["diminish", *command]) + ".1"]

    def test_finds_the_commands(self):
        self.assertIn(["calibrate", "rig"], COMMANDS)
        self.assertIn("--inpaint", flags(["run"]))
        self.assertIn("--no-refine-poses", flags(["run"]))

    def test_help_of_a_command_is_its_help(self):
        self.assertEqual(run(PROGRAM, "help"), help_of())
        self.assertEqual(run(PROGRAM, "help", "calibrate", "rig").splitlines()[4:], help_of("calibrate", "rig").splitlines()[4:])
        self.assertEqual(run(PROGRAM, "help", "run", "--man"), self.page(["run"]))
        for shell, script in (("bash", self.bash), ("zsh", self.zsh), ("fish", self.fish)):
            self.assertEqual(run(PROGRAM, "help", "--completion", shell), script)
        wrong = subprocess.run([PROGRAM, "help", "calibrate", "moon"], capture_output=True, text=True)
        self.assertEqual(wrong.returncode, 1)
        self.assertIn("expected a command of diminish calibrate, got 'moon'", wrong.stderr)

    def test_man_pages_have_every_flag(self):
        for command in COMMANDS:
            page = self.page(command)
            plain = re.sub(r"\\f[BIR]", "", page).replace("\\-", "-")
            words = set(re.findall(r"-[\w-]+", plain))
            self.assertFalse(flags(command) - words, command)
            for child in below(command):
                self.assertIn("-".join(["diminish", *child]) + "(1)", plain)

    @unittest.skipUnless(shutil.which("groff"), "needs groff")
    def test_man_pages_are_well_formed(self):
        for command in COMMANDS:
            page = self.page(command)
            done = subprocess.run(
                ["groff", "-man", "-ww", "-Tutf8", "-P-c"], input=page, capture_output=True, text=True
            )
            self.assertEqual(done.stderr, "", command)
            for flag in flags(command):
                self.assertIn(flag, re.sub(".\x08", "", done.stdout))

    def test_bash_completes_every_flag_and_command(self):
        script = self.bash
        offered = completions(script, [["diminish", *command, "-"] for command in COMMANDS])
        for command, words in zip(COMMANDS, offered):
            self.assertEqual(words, flags(command), command)
        parents = [command for command in COMMANDS if below(command)]
        offered = completions(script, [["diminish", *command, ""] for command in parents])
        for command, words in zip(parents, offered):
            self.assertEqual(words, {child[-1] for child in below(command)})

    def test_bash_completes_values(self):
        script = self.bash
        methods = set(re.search(r"--inpaint \{(\S+)\}", help_of("run"))[1].split(","))
        with_s = {method for method in methods if method.startswith("s")}
        self.assertGreater(len(with_s), 1)
        offered = completions(
            script,
            [
                ["diminish", "run", "somewhere", "--inpaint", ""],
                ["diminish", "run", "--inpaint", "=", "s"],
                ["diminish", "run", "--inpaint", "="],
                ["diminish", "run", "--threads", ""],
                ["diminish", "calibrate", "intrinsics", "--lens", "fi"],
                ["diminish", "run", "/proc/sel"],
                ["diminish", "report", "/", "/", "--out", "/etc/passw"],
            ],
        )
        self.assertEqual(offered[0:3], [methods, with_s, methods])
        self.assertEqual(offered[3:6], [set(), {"fisheye"}, {"/proc/self"}])
        self.assertIn("/etc/passwd", offered[6])

    @unittest.skipUnless(shutil.which("fish"), "needs fish")
    def test_fish_completes_every_flag(self):
        script = self.fish
        for command in COMMANDS:
            line = " ".join(["diminish", *command, "--"])
            offered = run("fish", "--no-config", "-c", f"source -; complete -C '{line}'", input=script)
            words = {line.split("\t")[0] for line in offered.splitlines()}
            self.assertFalse({flag for flag in flags(command) if flag.startswith("--")} - words, command)

    @unittest.skipUnless(shutil.which("zsh"), "needs zsh")
    def test_zsh_reads_its_script(self):
        script = self.zsh
        functions = run("zsh", "-f", "-c", "compdef() { :; }; _arguments() { print -rl -- $@; return 0 }\n" + script)
        self.assertIn("--version", functions)
        for command in COMMANDS:
            name = "_".join(["_diminish", *command]).replace("-", "_")
            given = run("zsh", "-f", "-c", "_arguments() { print -rl -- $@; return 0 }\n" + script + f"\n{name}")
            for flag in flags(command):
                self.assertRegex(given, rf"(?m)^\*?{re.escape(flag)}=?\[")


if __name__ == "__main__":
    unittest.main()
