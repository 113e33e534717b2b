"""Every command that documents, docstrings and helps print is taken by its program and run; files they name are there.

Commands are found, not listed: in fenced blocks and in code of the pages, in docstrings, in the examples of ``--help``. Each is
given to the parser of its own program; short ones are run as well, the others nightly, in the smallest size (`SMALLER`), one case
of a drive, and once where several differ only in what does not change the way through the program (`way_of`). Those of ``cyclo``
run in forks with coarse derivations (``tests/plugins/forked_commands.py``); all share one cache of coefficients.
CHANGELOG, and lines of apt, pip, git and pytest, are no part of it.

Run as a program (``python tests/test_printed_commands.py``, commands as JSON on the standard input) this file parses commands
of Python scripts, each in a fork of a process that has the libraries already.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import re
import runpy
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
from contextlib import redirect_stdout, suppress
from functools import cache
from importlib import import_module
from importlib.util import module_from_spec, spec_from_file_location
from itertools import pairwise
from pathlib import Path

import needs
import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).resolve().parents[1]
OURS = ("ltca", "fem", "validation")
CODE = re.compile(r"``([^`]+)``|`([^`]+)`")
FENCE = re.compile(r"```(\w*)\n(.*?)```", re.DOTALL)
VENV = re.compile(r"^(?:\.venv/bin/|\.venv\\Scripts\\)")
"""What stands before a program of an environment, on Windows too."""
COMMAND = re.compile(rf"(?:{VENV.pattern})?(?:cyclo|python3?)\s+\S")
PLACEHOLDERS = {"DRIVE": "paper", "REQUIREMENTS.toml": "requirements.toml", "FILE": "file.nc", "NAME": "CS-1", "N": "1",
                "K": "0", "C": "0.1", "H": "0.1", "DIR": "out", "φ": "0.5", "COMMAND": "run"}  # fmt: skip
"""What stands in usage lines for a value."""

READERS = {
    "my.toml", "joint.toml", "printed.toml", "rv.toml", "study.toml", "requirements.toml", "REQUIREMENTS.toml", "mine.nc",
    "coefficients.nc", "bench.csv", "file.nc", "old.nc", "flank.csv", "answers.json", "disc_flank.csv",
    "_flank.csv", "_circles.csv",
}  # fmt: skip
"""Names that stand for a file of the reader's own."""

SMALLER = {
    "run": "--positions 4 --no-figures",
    "check": "--positions 17",
    "tolerance": "--samples 8 --positions 17 --no-figures --force",
    "sweep": "--no-figures",
    "optimise": "--generations 1 --positions 4 --no-figures",
    "curves": "--turns 4 --no-figures",
    "dynamics": "--positions 4",
    "design": "--best 1",
    "derive": "--stations 0.25 --size 2",
    "fem": "--size 3",
    "mesh": "--size 4",
    "validate": "--level quick --angles 0.5 --size 4",
    "benchmarks/aligned_slices.py": "--count 1 --slices 5 9",
    "benchmarks/before_and_after.py": "--count 2 --drive sleeved",
    "benchmarks/contract.py": "full-fe --fields 1",
    "benchmarks/equilibria.py": "--positions 4 --rounds 1",
    "benchmarks/faults.py malformed": "--count 3",
    "benchmarks/faults.py kills": "--kills 1 --commands run",
    "benchmarks/faults.py clusters": "--kills 1",
    "benchmarks/faults.py discs": "--sizes 64k --commands run",
    "benchmarks/faults.py folders": "--pairs 1 --commands run",
    "benchmarks/fem.py": "--sizes 6 --series-size 6 ?--ccx 6 ?--series 2 ?--refereed 1",
    "benchmarks/free_play.py": "--count 1",
    "benchmarks/half_space_errors.py": "--positions 4 --drive paper",
    "benchmarks/imports.py": "--rounds 1",
    "benchmarks/methods.py": "--positions 4",
    "benchmarks/modelling_choices.py": "--positions 1 --stations 0.25",
    "benchmarks/paper_method.py": "--positions 4",
    "benchmarks/plane_or_width.py": "--drive robot-joint --positions 4 --turns 1",
    "benchmarks/practical_models.py": "--direct 1 --hybrid 0 --fe 0 --full 0",
    "benchmarks/random_drives.py": "--count 4",
    "benchmarks/run_paper.py": "--rounds 1",
    "benchmarks/shipped_coefficients.py": "--only sleeved",
    "benchmarks/solid_cylinder.py": "--size 4 --layers 2",
    "benchmarks/solid_free_ends.py": "--size 8 --cells 6",
    "benchmarks/solid_moves.py": "paper --case CS-1 --positions 1 --plane mine.nc --solid solid.nc",
    "benchmarks/spring_of_pins.py": "--positions 1 --only free",
    "benchmarks/startup.py": "--runs 1 --only help",
    "benchmarks/studio.py": "--edits 2",
    "benchmarks/study_costs.py": "--quick --joint robot-joint",
    "benchmarks/suite_times.py": "--processes 1 -- tests/test_import_directions.py",
    "benchmarks/summary_numbers.py": "--positions 4 --drive paper",
    "benchmarks/tolerance.py": "--samples 40",
    "benchmarks/torque_share.py": "--positions 3 --samples 2 --first 1",
    "benchmarks/wide_contacts.py": "--widths 0.1",
    "fem.testing.reference_fields": "--out fields.json",
    "validation.seats": "--out pictures",
}
"""Options that make a command small: of two of one name the last one counts; behind ? only where the command has it."""

LEFT_OUT = {
    r"tcp://": "asks for a dask scheduler (benchmarks/faults.py clusters starts its own)",
    r" --resume\b": "goes on with what a larger run left; tests/faults does so",
    r"out/t/samples/": "a file of a larger run",
    r"\[-h\]": "the usage that argparse writes itself",
    r"--load-rating \"5 kN\"$": "an option behind the name of its command",
    r"--write\b": "would replace tests/budget.toml; the same without it is run",
    r"validation\.shipped_tables": "would replace tables of the package; tests/validation/test_shipped_tables.py makes them",
    r"tests\.test_pictures": "would replace pictures of the documents, which the same file and test_robot_joint.py compare",
    r"tests\.test_quantities": "would replace the schema of the package, which the same file compares",
    r"validation\.levels\.other_codes": "asks codes that are not everywhere, and would replace their stored answers",
    r"moving_arm\.py out/": "needs what the command before it wrote; tests/ltca/commands/test_robot_joint.py runs the page",
    r"cyclo validate$": "a mention: it needs a drive or --manual",
    r"validate --manual": "tests/validation/manual computes every case, tests/validation/commands runs the command",
    r"cyclo studio\b": "serves until it is ended; tests/ltca/studio does so",
    r"solid_(ltca|or_plane)\.py": "minutes at any size at which meshes fit; tests/fem/solid_drive solves such drives",
    r"mutants\.py": "its map alone takes longer than all tests; tests/test_mutants.py runs its parts",
    r"random_drives\.py --count N$": "a usage; its number is a placeholder",
}
"""Commands that no test runs, and why; each is parsed all the same. So are mentions: `cyclo run`, without what it needs."""

NEEDED = {
    r"--ccx|--refereed|--referee calculix": "calculix",
    r"benchmarks/studio\.py": "studio",
    r"benchmarks/faults\.py clusters": "cluster",
}
"""Commands that need an extra or another program (`needs`), and are left out where it is missing."""

COMMIT = "HEAD~1"
"""Stands for every commit: one is as good as another."""

LONGEST = 300
"""Processor time, s, of one process after which a command is not small: beside other work 32 s took a quarter of an hour."""

SHORT = ("fields", "quantities", "init", "show")
"""Commands that take a second or so as they are printed."""

DERIVED = {"paper", "my.toml", "--check", "--help"}
"""One of these is in every command of ``cyclo derive`` that is more than a mention: its drive may be left out with --check."""

ELSEWHERE = {"sphinx", "build", "pytest", "venv", "twine"}
"""Modules of other people that .ci/run calls itself, with these words."""


@cache
def pages() -> list[tuple[str, str]]:
    """Return name and text of every page that people read, those that the program writes included."""
    found = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "SECURITY.md")]
    built = ("docs/reference/generated/", "docs/gallery/", "docs/build/")
    for ending in ("md", "rst"):
        found += [*(ROOT / "docs").rglob(f"*.{ending}"), *(ROOT / "examples").rglob(f"*.{ending}")]
    texts = [(path.relative_to(ROOT).as_posix(), path.read_text(encoding="utf-8")) for path in sorted(found)]
    spec = spec_from_file_location("generated_pages", ROOT / "docs" / "generated_pages.py")
    written = module_from_spec(spec)
    spec.loader.exec_module(written)
    texts += [(f"generated {name}", getattr(written, name)()) for name in ("commands_page", "drive_file_page")]
    return [(name, text) for name, text in texts if not name.startswith(built)]


@cache
def docstrings() -> list[tuple[str, str]]:
    """Return place and text of every docstring."""
    found = []
    for folder in (*OURS, "benchmarks", "examples", "docs"):
        for path in sorted((ROOT / folder).rglob("*.py")):
            if "gallery" in path.parts or "build" in path.parts:
                continue
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (text := ast.get_docstring(node)):
                    found += [(path.relative_to(ROOT).as_posix(), text)]
    return found


def commands_in(text: str, lines_too: bool) -> dict[str, bool]:
    """Return what a text prints as commands, and whether each is a line to be typed or code within a sentence.

    Lines of shell blocks, whole pieces of code; in docstrings any line.
    """
    lines = [block for language, block in FENCE.findall(text) if language in ("sh", "powershell", "text", "")]
    pieces = [
        " ".join(part.split())
        for one, two in CODE.findall(FENCE.sub("", text))
        for part in re.split(r"; (?=cyclo |python )", one or two)
    ]
    if lines_too:
        lines.append(text)
    shell = "\n".join(lines).replace("\\\n", " ").splitlines()
    typed = [part.strip() for line in shell for part in line.split("  # ")[0].split("&&")]
    found = dict.fromkeys(pieces, False) | dict.fromkeys(typed, True)
    return {piece: whole for piece, whole in found.items() if COMMAND.match(piece) and "import ltca " not in piece}


@cache
def printed() -> dict[str, tuple[str, bool]]:
    """Return every command that is printed, with the place that prints it and whether one prints it as a line to be typed."""
    found: dict[str, tuple[str, bool]] = {}
    for texts, lines_too in ((pages(), False), (docstrings(), True)):
        for place, text in texts:
            for command, whole in commands_in(text, lines_too).items():
                if whole > found.get(command, ("", False))[1] or command not in found:
                    found[command] = place, whole
    return found


def words_of(command: str, whole: bool) -> tuple[list[str], bool]:
    """Return the words of a command, placeholders replaced, and whether it has to be complete: no mention, nothing left out."""
    plain = re.sub(r" \| [A-Z]+", "", VENV.sub("", command))
    plain = re.sub(r"(\w)\|[\w|-]+", r"\1", plain).replace("[", " ").replace("]", " ")
    if "import ltca" in plain:
        plain = VENV.sub("", command)
    words = [PLACEHOLDERS.get(word, word) for word in shlex.split(plain, comments=True)]
    kept = [word for word in words if word not in ("…", "...")]
    return kept, whole and kept == words and "[-h]" not in command


class Taken(BaseException):
    """Raised in place of the work once the parser has taken the words."""


def trouble_of(words: list[str], whole: bool) -> str:
    """Return what is wrong with a command; it is parsed in this process and not run."""
    told: list[str] = []
    taken = argparse.ArgumentParser.parse_args

    def error(self, message):
        options = [word.partition("=")[0] for word in words if word.startswith("--")]
        unknown = [option for option in options if option not in self._option_string_actions]
        # A mention may lack what is required, or the value of its last option.
        lacks = "required" in message or words[-1] in options or not rest[1:]
        if unknown or whole or not lacks:
            told.append(f"{message}{', unknown: ' + ' '.join(unknown) if unknown else ''}")
        raise Taken

    def parse_args(self, *arguments):
        taken(self, *arguments)
        raise Taken

    program, *rest = words
    patch = pytest.MonkeyPatch()
    patch.setattr(argparse.ArgumentParser, "error", error)
    try:
        with suppress(Taken), Path(os.devnull).open("w") as nowhere, redirect_stdout(nowhere):
            if program == "cyclo":
                from ltca.commands import program as cyclo

                patch.setattr(cyclo._Parser, "error", error)
                cyclo.build_parser(rest[0]).parse_args(rest)
                return ""
            patch.setattr(argparse.ArgumentParser, "parse_args", parse_args)
            while rest[0] == "-X":
                rest = rest[2:]
            if rest[0] == "-c":
                compile(rest[1], "-c", "exec")
                return ""
            module = rest[0] == "-m"
            name, *arguments = rest[module:]
            patch.setattr(sys, "argv", [name, *arguments])
            if module:
                runpy.run_module(name, run_name="__main__", alter_sys=True)
            else:
                if not (ROOT / name).is_file():
                    return f"{name} is not there"
                patch.setattr(sys, "path", [str((ROOT / name).parent), *sys.path])
                runpy.run_path(str(ROOT / name), run_name="__main__")
            return "it has no parser of arguments"
    except SystemExit as end:
        return "" if end.code in (None, 0) else f"exit status {end.code}"
    except Exception as failure:  # noqa: BLE001 - whatever a script may raise is what is looked for
        return f"{type(failure).__name__}: {failure}"
    finally:
        patch.undo()
    return "; ".join(told)


def parse_in_forks() -> None:
    """Read commands from the standard input, parse each in a fork and write what is wrong."""
    sys.path[0] = str(ROOT)  # tests/ltca is no package
    ours = ("ltca.facade", "ltca.analysis.engines", "ltca.studies.study", "fem.reducer.solution")
    for name in (*ours, "xarray", "scipy.optimize", "scipy.interpolate"):
        import_module(name)  # for all forks at once
    answers = []
    for words, whole in json.load(sys.stdin):
        with tempfile.TemporaryFile("w+") as stream:
            child = os.fork()
            if child == 0:
                signal.alarm(60)  # a script that works before it parses
                answer = trouble_of(words, whole)
                stream.write(answer)
                stream.flush()
                os._exit(0)
            status = os.waitpid(child, 0)[1]
            stream.seek(0)
            answers.append(stream.read() if status == 0 else f"ended with {status}")
    json.dump(answers, sys.stdout)


def place_of(command: str) -> str:
    """Return which text prints a command."""
    return printed().get(command, ("its --help", False))[0]


def all_words() -> dict[str, tuple[list[str], bool]]:
    """Return the words of every command that is ours to take."""
    found = {}
    for command, (_, whole) in printed().items():
        words, complete = words_of(command, whole)
        if words[1:2] == ["-m"] and words[2].split(".")[0] in ELSEWHERE:
            continue
        if words[0] != "cyclo" and words[1].endswith(".py") and not words[1].startswith(("benchmarks/", "examples/")):
            continue  # what is named alone: the test of files looks for it
        found[command] = words, complete
    return found


@pytest.mark.slow
def test_commands_are_found():
    """The search itself: commands of each kind are among those found."""
    found = printed()
    assert len(found) > 100
    for command in (
        "cyclo show paper --case CS-3 --angle 0.5", "python benchmarks/torque_share.py", "python -m validation.seats",
        "cyclo fields thickness", "python benchmarks/faults.py discs", ".venv/bin/cyclo run paper",
    ):  # fmt: skip
        assert command in found
    text = "`cyclo run x`\n```sh\ncyclo a \\\n  --b  # c\n```"
    assert commands_in(text, False) == {"cyclo run x": False, "cyclo a    --b": True}
    ci = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    assert all(name in ci for name in ELSEWHERE)


@pytest.mark.slow
def test_every_printed_command_is_taken_by_its_program():
    """Of ``cyclo`` in this process; a mention without its arguments (`cyclo run`) counts for its options alone."""
    wrong = []
    for command, (words, whole) in all_words().items():
        if words[0] == "cyclo" and (trouble := trouble_of(words, whole)):
            wrong.append(f"{place_of(command)}: {command}: {trouble}")
    assert not wrong, "\n".join(wrong)


def test_what_no_program_takes_is_seen():
    for whole in (False, True):
        assert "unknown: --speedy" in trouble_of(["cyclo", "run", "--speedy"], whole)
        assert "invalid choice" in trouble_of(["cyclo", "rnu", "paper"], whole)
        assert "is not there" in trouble_of(["python", "benchmarks/numbers.py", "HEAD"], whole)
        assert "No module named" in trouble_of(["python", "-m", "validation.seat"], whole)
        assert "whole number" in trouble_of(["cyclo", "run", "paper", "--positions", "many"], whole)
    for words in (
        ["cyclo", "run"], ["cyclo", "run", "paper", "--angles"], ["cyclo", "export", "paper"],
        ["python", "benchmarks/summary_numbers.py"], ["python", "benchmarks/faults.py"],
    ):  # fmt: skip
        assert trouble_of(words, False) == ""
        assert trouble_of(words, True) != ""


def troubles_of_scripts(asked: list[tuple[list[str], bool]]) -> list[str]:
    """Return what is wrong with each of these commands of Python scripts; they are parsed by this file as a program."""
    command = [sys.executable, str(Path(__file__).resolve())]
    run = subprocess.run(
        command, input=json.dumps(asked), capture_output=True, text=True, cwd=ROOT, check=False, timeout=600,
        env=os.environ | {"PYTHONPATH": str(Path(needs.__file__).parent)},
    )  # fmt: skip
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


def extra_of(words: list[str]) -> str:
    """Return the extra that a script imports from before it parses its words; empty for most."""
    path = ROOT / words[1]
    if not path.is_file():
        return ""
    nodes = ast.parse(path.read_text(encoding="utf-8")).body
    modules = {name.name for node in nodes if isinstance(node, ast.Import) for name in node.names}
    modules |= {node.module for node in nodes if isinstance(node, ast.ImportFrom) and node.module}
    tops = {module.partition(".")[0].replace("_", "-") for module in modules}
    return next((extra for extra, names in needs.extras().items() if extra != "test" and tops & set(names)), "")


@pytest.mark.slow
@pytest.mark.parametrize("extra", ["", pytest.param("robotics", marks=pytest.mark.needs("robotics"))])
def test_every_printed_script_is_taken_by_its_program(extra):
    """Where its modules are installed: a script that imports mujoco failed in a fresh environment of `.[test]`."""
    asked = {command: entry for command, entry in all_words().items() if entry[0][0] != "cyclo"}
    asked |= {f"python {path}": (["python", path, "--help"], True) for path in benchmarks()}
    assert {extra_of(words) for words, _ in asked.values()} == {"", "robotics"}
    asked = {command: entry for command, entry in asked.items() if extra_of(entry[0]) == extra}
    answers = zip(asked, troubles_of_scripts(list(asked.values())), strict=True)
    wrong = [f"{place_of(command)}: {command}: {answer}" for command, answer in answers if answer]
    assert not wrong, "\n".join(wrong)


def benchmarks() -> list[str]:
    """Return every benchmark by its path in the repository."""
    return [f"benchmarks/{path.name}" for path in sorted((ROOT / "benchmarks").glob("*.py"))]


def test_every_benchmark_is_listed():
    text = (ROOT / "docs" / "reference" / "benchmarks.md").read_text(encoding="utf-8")
    assert [name for name in benchmarks() if f"python {name}" not in text] == []


def test_no_script_hides_a_module():
    """A script's folder comes first where modules are looked for; those that use `fem` take it away (benchmarks/fem.py)."""
    scripts = [path for folder in ("benchmarks", "examples", "docs") for path in (ROOT / folder).glob("*.py")]
    assert [path.name for path in scripts if path.stem in sys.stdlib_module_names] == []
    hidden = [path for path in scripts if path.stem in OURS]
    assert [path.relative_to(ROOT).as_posix() for path in hidden] == ["benchmarks/fem.py"]
    for path in (ROOT / "benchmarks").glob("*.py"):
        text = path.read_text(encoding="utf-8")
        if re.search(r"^ *from (fem|validation)\.", text, flags=re.MULTILINE):  # validation takes from fem
            assert "sys.path[0] = " in text, path.name


NAMED = re.compile(
    r"(?<![\w/<*{.-])((?:\.\./|\./)*[\w./-]*\w\.(?:py|toml|md|msh|rst|json|nc|csv|npz|html|inp))(?![\w/*])"
)


def test_every_named_file_is_there():
    """A path from the root or beside the page, the end of a path in the repository, a name that some program writes."""
    listed = [path.relative_to(ROOT).as_posix() for folder in (*OURS, "benchmarks", "examples", "docs", "tests", "meshes")
              for path in (ROOT / folder).rglob("*") if path.is_file() and "__pycache__" not in path.parts]  # fmt: skip
    listed += [path.name for path in ROOT.iterdir() if path.is_file()]
    ends = {"/".join(path.split("/")[start:]) for path in listed for start in range(path.count("/") + 1)}
    missing = []
    for place, text in (*pages(), *docstrings()):
        pieces = [one or two for one, two in CODE.findall(FENCE.sub("", text))] + [
            block for _, block in FENCE.findall(text)
        ]
        for name in NAMED.findall("\n".join(pieces)):
            plain = name.removeprefix("./")
            last = plain.rsplit("/", 1)[-1]
            if (
                plain in ends
                or plain in READERS
                or plain.startswith(("out/", "build/", "/", "gallery/"))
                or last.split(".")[0].isupper()
                or "generated/" in plain
            ):
                continue
            if (ROOT / place).parent.joinpath(name).exists() or ("/" not in plain and is_written(plain)):
                continue
            missing.append(f"{place}: {name}")
    assert not missing, "\n".join(missing)


@cache
def names_in_code() -> frozenset[str]:
    """Return every text in the code that ends like a file, what is filled in later as 0."""
    found = set()
    for path in (path for folder in OURS for path in (ROOT / folder).rglob("*.py")):
        for text in re.findall(r"""["']([^"'\n ]*\.[a-z]{2,4})["']""", path.read_text(encoding="utf-8")):
            found.add(re.sub(r"\{[^{}]*\}|\[0-9\]|[*]", "0", text).rsplit("/", 1)[-1])
    return frozenset(found)


def is_written(name: str) -> bool:
    """Tell whether the code names a file that it writes or reads, what is filled in left open."""
    return name in names_in_code() or any(
        re.fullmatch(re.escape(one).replace("0", "[\\w.-]*"), name) for one in names_in_code() if "0" in one.strip("0")
    )


class Runner:
    """Run commands in one folder, those of ``cyclo`` in forks of one process, and keep what each took."""

    def __init__(self, folder: Path, cache: Path) -> None:
        self.folder = folder
        self.environment = os.environ | {"MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(cache)}
        self.spent: dict[str, float] = {}
        """Processor time, s, by command."""
        self._forks = subprocess.Popen(
            [sys.executable, str(Path(needs.__file__).parent / "forked_commands.py")],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=self.environment,
        )  # fmt: skip

    def run(self, words: list[str]) -> str:
        """Run a command and return what went wrong; a failed check is an answer."""
        if words[0] == "cyclo":
            print(json.dumps([words[1:], str(self.folder), LONGEST]), file=self._forks.stdin, flush=True)
            status, said, seconds = json.loads(self._forks.stdout.readline())
        else:
            status, said, seconds = self._run_script(words[1:])
        self.spent[" ".join(words)] = seconds
        # Checks may fail: of a drive, or of the coarse mesh of coefficients.
        allowed = (0, 1) if words[1:2] in (["check"], ["validate"], ["derive"]) else (0,)
        return "" if status in allowed else f"exit status {status}: {said.strip()[-300:]}"

    def _run_script(self, words: list[str]) -> tuple[int, str, float]:
        """Run a Python script and return its exit status, what it said and its processor time, s."""
        rest = [str(ROOT / word) if word.startswith(("benchmarks/", "examples/")) else word for word in words]
        before = os.times()
        limited = ["bash", "-c", f'ulimit -t {LONGEST} && exec "$@"', "bash", sys.executable, *rest]
        try:
            done = subprocess.run(
                limited, cwd=self.folder, env=self.environment, capture_output=True, text=True, check=False,
                timeout=10 * LONGEST,
            )  # fmt: skip
        except subprocess.TimeoutExpired:  # one that waits for ever
            return -signal.SIGALRM, f"not done after {10 * LONGEST} s", LONGEST
        after = os.times()
        seconds = after.children_user + after.children_system - before.children_user - before.children_system
        return done.returncode, done.stderr, seconds

    def close(self) -> None:
        """Let the process of the forks end, and print what took longest."""
        self._forks.communicate()
        print(f"{len(self.spent)} commands, {sum(self.spent.values()):.0f} s of processor time; the slowest:")
        for command, seconds in sorted(self.spent.items(), key=lambda item: -item[1])[:20]:
            print(f"{seconds:6.0f} s {command}", flush=True)


CASES = ("check", "curves", "dynamics", "export", "fem", "mesh", "validate", "tolerance", "optimise")
"""Commands that take every case of a drive, or ask for one, where none is named; ``cyclo run`` does so too, in a second."""


def one_case(words: list[str], folder: Path) -> list[str]:
    """Return a command with the first case of its drive, where it has several and none is named."""
    from ltca.reading.drive_file import load_drive

    if words[0] != "cyclo" or words[1] not in CASES or "--case" in words or "--help" in words:
        return words
    if any(word.startswith("out/") for word in words[2:3]):  # made by a command, of one case
        return words
    name = words[2] if len(words) > 2 and not words[2].startswith("-") else "paper"
    cases = load_drive(str(folder / name) if name.endswith(".toml") else name).cases
    return [*words, "--case", next(iter(cases))] if len(cases) > 1 else words


def way_of(words: list[str], read: frozenset[str]) -> tuple[object, ...]:
    """Return what the way of a command through its program depends on.

    Of an option that stands twice the last one counts, but for those that add up; where the results go does not, unless a printed
    command reads them there (`read`); nor does a number of workers, a seed, or which commit is asked for.
    """
    head: list[str] = []
    options: dict[str, list[str]] = {}
    group = head
    for word in words:
        if re.match(r"--[a-z]", word):
            group = options.setdefault(word, [])
            if word not in ("--subject", "--case"):
                group.clear()
        else:
            group.append(word)
    place = " ".join(options.get("--out", []))
    if place == "out" or not any(f"{name}/".startswith(f"{place}/") for name in read):  # a folder below it is read
        options.pop("--out", None)
    for name in ("--seed", "--force", "--workers"):
        options.pop(name, None)
    same = {"requirements.toml": "examples/requirements/possible-paper.toml"}
    if "validate" in head[:2]:  # some minutes each
        same["my.toml"] = "paper"
        options.setdefault("--case", ["CS-1"])
    head = [COMMIT if re.fullmatch(r"HEAD(~\d)?|[0-9a-f]{7,40}", word) else same.get(word, word) for word in head]
    return (*head, *sorted((name, *values) for name, values in options.items()))


def results_read(commands: list[list[str]]) -> frozenset[str]:
    """Return the results that some of these commands read where others write them: not behind ``--out``."""
    return frozenset(
        word for words in commands for before, word in pairwise(words) if word.startswith("out/") and before != "--out"
    )


def made_small(words: list[str]) -> list[str]:
    """Return a command with what makes it small behind it."""
    if "-m" in words:
        kind = words[words.index("-m") + 1]
    else:
        kind = " ".join(words[1:3]) if words[1] == "benchmarks/faults.py" else words[1]
    small = []
    for group in re.split(r" (?=\??--(?:\w| ))", SMALLER.get(kind, "")):
        if not group.startswith("?") or group[1:].split()[0] in words:
            small += shlex.split(group.removeprefix("?"))
    if kind == "run" and "--angles" in words:  # instead of a number of positions
        del small[small.index("--positions") : small.index("--positions") + 2]
    if "--figures" in words and "--no-figures" in small:
        small.remove("--no-figures")
    if kind == "dynamics" and "--time" in words:  # has no positions
        small = ["--time", "1 ms", "--compliance", "half-space"]
    if kind == "curves" and "--parts" in words:  # a run for each part
        small.append("--quick")
    if kind == "fem" and "--angle" not in words and "--export" not in words:
        small += ["--angle", "0.5"]
    if kind == "fem" and "--referee" in words:
        small += ["--size", "6"]
    if kind == "export" and "--for" in words and "--quick" not in words:
        small.append("--quick")
    if kind == "derive" and "solid" in words:
        small += ["--layers", "2"]
    if kind == "fem" and "solid" in words and "--pair" not in words:  # the same with a sixth of the pins: in a minute
        words = ["examples/drives/plastic.toml" if word == "paper" else word for word in words]
        small = ["--angle", "0.3", "--size", "4"]
    if kind == "benchmarks/startup.py" and "--fem" in words:
        small[-1] = "full FE"
    if kind == "derive" and "--check" in words:  # derives nothing
        small = []
    if kind == "derive" and "ring" in words:  # a body without stations
        words = ["examples/drives/whole_reducer.toml" if word == "paper" else word for word in words]
        small = ["--size", "2"]
    of_the_paper = (kind == "derive" and "paper" in words) or (kind == "run" and "--coefficients" in words)
    if of_the_paper and "--case" not in words:  # clearances are those of a case
        small += ["--case", "CS-1"]
    return [*words, *small]


def why_left_out(command: str) -> str:
    """Return why a command is not run; nothing where it is."""
    for pattern, need in NEEDED.items():
        if re.search(pattern, command) and (reason := needs.missing(need)):
            return reason
    return next((reason for pattern, reason in LEFT_OUT.items() if re.search(pattern, command)), "")


def start_page(folder: Path) -> None:
    """Write the drive files of a reader who begins a page; commands of another page may have replaced them."""
    from ltca.commands.program import main

    for name, like in (("my", "paper"), ("joint", "robot-joint"), ("printed", "robot-joint"), ("rv", "rv")):
        path = folder / f"{name}.toml"
        path.unlink(missing_ok=True)
        assert main(["init", str(path), "--like", like]) == 0


def set_up(folder: Path) -> None:
    """Put the files that readers have into a folder."""
    start_page(folder)
    shutil.copytree(ROOT / "examples", folder / "examples")
    shutil.copy(ROOT / "examples" / "requirements" / "possible-paper.toml", folder / "requirements.toml")
    block = next(
        text for language, text in FENCE.findall((ROOT / "docs/how-to/studies.md").read_text(encoding="utf-8"))
        if language == "toml" and "[factors" in text
    )  # fmt: skip
    (folder / "study.toml").write_text(block, encoding="utf-8")
    shutil.copytree(ROOT / "meshes", folder / "meshes")
    (folder.parent / "before").symlink_to(ROOT)  # the other checkout of benchmarks/startup.py


def test_what_is_left_out_is_printed_and_not_more():
    """A reason for a command that nobody prints any more is to go."""
    for pattern in (*LEFT_OUT, *NEEDED):
        assert any(re.search(pattern, command) for command in printed()), pattern
    kinds = {" ".join(words) for words, _ in all_words().values()}
    assert [kind for kind in SMALLER if not any(kind in words for words in kinds)] == []
    assert made_small(["cyclo", "run", "x", "--angles", "0"])[-2:] == ["0", "--no-figures"]
    assert made_small(["python", "benchmarks/suite_times.py"])[-2:] == ["--", "tests/test_import_directions.py"]
    assert "--ccx" not in made_small(["python", "benchmarks/fem.py"])
    assert made_small(["python", "benchmarks/fem.py", "--ccx", "1"])[-2:] == ["--ccx", "6"]


@pytest.mark.slow
def test_short_commands_run_as_they_are_printed(tmp_path, monkeypatch, capsys):
    from ltca.commands.program import main

    folder = tmp_path / "here"
    folder.mkdir()
    set_up(folder)
    monkeypatch.chdir(folder)
    wrong = []
    for command, (words, _) in all_words().items():
        if words[0] != "cyclo" or words[1] not in SHORT or "--help" in words or why_left_out(command):
            continue
        if trouble_of(words, True):  # a mention
            continue
        if words[1] == "init":
            (folder / words[2]).unlink(missing_ok=True)
        status = main(words[1:])
        if status != 0:
            wrong.append(f"{place_of(command)}: {command}: exit status {status}: {capsys.readouterr().err}")
    assert not wrong, "\n".join(wrong)


def kind_of(words):
    """Which of three runs of all printed commands one belongs to, so that several workers share them."""
    if words[0] == "cyclo":
        return "cyclo"
    return "faults" if any(word.endswith("faults.py") for word in words) else "python"


@pytest.fixture(scope="module")
def runner(tmp_path_factory):
    """The folder of a reader, and what runs commands in it; kinds that one worker runs share what is derived."""
    place = tmp_path_factory.mktemp("printed")
    (place / "here").mkdir()
    set_up(place / "here")
    found = Runner(place / "here", place / "cache")
    yield found
    found.close()


MADE_BEFORE = {
    "mine.nc": "cyclo derive my.toml --case CS-1 --out mine.nc --stations 0.25 --size 2",
    "solid.nc": "cyclo derive paper --case CS-1 --bodies solid --out solid.nc --stations 0.25 --size 2 --layers 2",
    "out/paper": "cyclo run paper --positions 4 --no-figures",
}
"""What readers have when they come to a command, and what makes it."""


def make_what_is_read(runner: Runner) -> None:
    """Make the results that commands of several pages read, once."""
    for name, command in MADE_BEFORE.items():
        if not (runner.folder / name).exists():
            assert runner.run(command.split()) == ""
    for name in ("coefficients.nc", "file.nc"):
        shutil.copy(runner.folder / "mine.nc", runner.folder / name)
    rows = "".join(f"{0.5 * degrees},{0.01 * degrees}\n" for degrees in range(720))
    (runner.folder / "bench.csv").write_text(f"crank_angle_deg,transmission_error_arcsec\n{rows}", encoding="utf-8")


def commands_of(kind: str) -> list[str]:
    """Return the commands of a kind that are run: mentions and those of `LEFT_OUT` are not."""
    asked = {
        command: words
        for command, (words, _) in all_words().items()
        if not why_left_out(command) and kind == kind_of(words)
    }
    scripts = [command for command, words in asked.items() if words[0] != "cyclo"]
    troubles = troubles_of_scripts([(asked[command], True) for command in scripts])
    mentions = {command for command, trouble in zip(scripts, troubles, strict=True) if trouble}
    mentions |= {
        command
        for command, words in asked.items()
        if words[0] == "cyclo" and (trouble_of(words, True) or (words[1] == "derive" and not set(words) & DERIVED))
    }
    return [command for command in asked if command not in mentions]


@pytest.mark.slow
def test_small_commands_are_taken_by_their_programs(tmp_path):
    """What makes a command small is an option that it has: every night would find it out late."""
    set_up(tmp_path)
    small = [one_case(made_small(all_words()[command][0]), tmp_path) for command in commands_of("cyclo")]
    wrong = [f"{' '.join(words)}: {trouble}" for words in small if (trouble := trouble_of(words, True))]
    scripts = [made_small(all_words()[command][0]) for kind in ("python", "faults") for command in commands_of(kind)]
    answers = zip(scripts, troubles_of_scripts([(words, True) for words in scripts]), strict=True)
    wrong += [f"{' '.join(words)}: {trouble}" for words, trouble in answers if trouble]
    assert not wrong, "\n".join(wrong)


def test_commands_that_differ_in_nothing_that_counts_run_once():
    """83 minutes of a night went to commands that did the same again."""

    def way(text, *read):
        return way_of(shlex.split(text), frozenset(read))

    same = "cyclo fem paper --angle 0.5 --size 4 --case CS-1"
    assert way("cyclo fem paper --case CS-1 --angle 0.5 --size 2 --size 4 --out out/x") == way(same)
    assert way("cyclo design requirements.toml --best 1") == way(
        "cyclo design examples/requirements/possible-paper.toml --best 1"
    )
    for other in ("cyclo fem paper --angle 0.5 --size 4 --case CS-1 --error", "cyclo fem my.toml --angle 0.5 --size 4"):
        assert way(other) != way(same)
    assert way("cyclo run paper --out out/x", "out/x/results.nc") != way("cyclo run paper", "out/x/results.nc")
    assert way("cyclo run paper --out out", "outer/results.nc") == way("cyclo run paper")
    # Every place of results was taken for one that a command reads, its own.
    assert results_read([["cyclo", "run", "paper", "--out", "out/x"]]) == frozenset()
    assert results_read([["cyclo", "check", "out/x/design-1.toml", "--out", "out/y"]]) == {"out/x/design-1.toml"}


@pytest.mark.slow
@pytest.mark.nightly
@pytest.mark.parametrize("kind", ["cyclo", "python", "faults"])
def test_every_printed_command_runs_small(kind, runner):
    """In the order of their needs: coefficients are derived first. ``-s`` shows times."""
    make_what_is_read(runner)
    commands = commands_of(kind)
    read = results_read([all_words()[command][0] for command in commands])
    wrong, page = [], ""
    done = {way_of(command.split(), read) for command in MADE_BEFORE.values()}
    for command in commands:
        if place_of(command) != page:
            page = place_of(command)
            start_page(runner.folder)
        words = made_small(all_words()[command][0])
        if words[1] == "init":
            (runner.folder / words[2]).unlink(missing_ok=True)
        words = one_case(words, runner.folder)
        if (way := way_of(words, read)) in done:
            continue
        done.add(way)
        if words[1] in ("run", "check", "curves", "dynamics", "optimise", "tolerance") and "--out" not in words:
            words += ["--out", f"out/{len(done)}"]
        trouble = runner.run(words)
        print(f"{runner.spent[' '.join(words)]:6.1f} s {' '.join(words)} {trouble}", flush=True)
        if trouble:
            wrong.append(f"{place_of(command)}: {' '.join(words)}: {trouble}")
    assert not wrong, "\n".join(wrong)


if __name__ == "__main__":
    parse_in_forks()
