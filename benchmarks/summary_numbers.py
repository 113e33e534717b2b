"""Compare the summaries of all shipped drives between two versions of the code.

    python benchmarks/summary_numbers.py HEAD~1            # against the working tree
    python benchmarks/summary_numbers.py HEAD~2 HEAD~1 --positions 36

A version is any git revision: a hash, a tag, a branch. Both are installed separately without dependencies
(``pip install --target``; they use the libraries installed here) and run the drives that they ship and that the other version can
read. Output is a Markdown table of the scalars of ``summary.json`` whose relative change exceeds ``--beyond``.
Exit status 2 for an unknown commit.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, TypeGuard

ROOT = Path(__file__).parents[1]
PROGRAM = (
    "import sys; from importlib.metadata import entry_points; "
    "(script,) = entry_points(group='console_scripts', name='cyclo'); sys.exit(script.load()())"
)


def add_drive_argument(parser: argparse.ArgumentParser) -> None:
    """Add an option that names shipped drives; without it there are all."""
    shipped = sorted(path.stem for path in (ROOT / "ltca" / "drives").glob("*.toml"))
    parser.add_argument(
        "--drive", action="append", choices=shipped, metavar="NAME", help="shipped drive, repeatable; default all"
    )


def commit_of(parser: argparse.ArgumentParser, revision: str) -> str:
    """Return the hash of a git revision; exit with a message if it does not exist."""
    words = ["git", "rev-parse", "--verify", "--quiet", "--end-of-options", f"{revision}^{{commit}}"]
    try:
        found = subprocess.run(words, cwd=ROOT, check=False, capture_output=True, text=True)
    except FileNotFoundError:
        parser.error("git is not installed: commits come from it")
    if found.returncode != 0:
        parser.error(
            f"{revision}: no commit of this repository (git log --oneline lists them; a shallow clone has few)"
        )
    return found.stdout.strip()


def install(revision: str | None, folder: Path) -> Path:
    """Install a commit, or the working tree, into a separate folder."""
    tree = folder / "tree"
    if revision is None:
        tree = ROOT
    else:
        tree.mkdir(parents=True)
        archive = subprocess.run(["git", "archive", revision], cwd=ROOT, check=True, stdout=subprocess.PIPE).stdout
        subprocess.run(["tar", "-x", "-C", str(tree)], input=archive, check=True)
    command = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--target",
        str(folder / "site"),
        str(tree),
    ]
    subprocess.run(command, check=True)
    return folder / "site"


def summaries(site: Path, drive: Path, positions: int, folder: Path) -> dict[str, dict[str, Any]] | None:
    """Return the summaries of all cases of a drive file; None if this version cannot read it."""
    environment = os.environ | {"PYTHONPATH": str(site), "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    words = ["run", str(drive), "--no-figures", "--positions", str(positions), "--out", str(folder)]
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, *words], env=environment, cwd=folder.parent, check=False, capture_output=True
    )
    if done.returncode != 0:
        print(done.stderr.decode(errors="replace")[-400:], file=sys.stderr)
        return None
    content = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    cases: dict[str, dict[str, Any]] = content.get("cases", content)
    return {name: values for name, values in cases.items() if isinstance(values, dict)}


def is_number(value: object) -> TypeGuard[float]:
    """Return whether a value is a number; booleans are not."""
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def rows(before: dict[str, Any], after: dict[str, Any], beyond: float) -> list[str]:
    """Return table rows for the scalars of both versions that have changed."""
    lines = []
    for name, old in before.items():
        new = after.get(name)
        if not (is_number(old) and is_number(new)):
            if old != new and name in after:
                lines.append(f"| `{name}` | {old} | {new} | |")
            continue
        scale = max(abs(old), abs(new))
        if scale > 0.0 and abs(new - old) > beyond * scale:
            lines.append(f"| `{name}` | {old:.6g} | {new:.6g} | {(new - old) / scale:+.2e} |")
    return lines


def main() -> None:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before", help="commit")
    parser.add_argument("after", nargs="?", help="commit; default the working tree")
    add_drive_argument(parser)
    parser.add_argument("--positions", type=int, default=360)
    parser.add_argument("--beyond", type=float, default=1e-9, help="relative change from which a scalar is listed")
    arguments = parser.parse_args()
    before = commit_of(parser, arguments.before)
    after = None if arguments.after is None else commit_of(parser, arguments.after)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sites = [install(before, folder / "before"), install(after, folder / "after")]
        drives = {path.stem: path for site in sites for path in sorted((site / "ltca" / "drives").glob("*.toml"))}
        chosen = {name: drives[name] for name in sorted(arguments.drive or drives)}
        for number, (drive, own) in enumerate(chosen.items()):
            found = []
            for side, site in zip(("before", "after"), sites, strict=True):
                shipped = site / "ltca" / "drives" / f"{drive}.toml"
                found.append(
                    summaries(
                        site, shipped if shipped.exists() else own, arguments.positions, folder / f"{side}{number}"
                    )
                )
            print(f"\n#### `{drive}`\n", flush=True)
            if found[0] is None or found[1] is None:
                which = arguments.before if found[0] is None else arguments.after or "the tree"
                print(f"{which} does not read it.")
                continue
            for case, values in found[1].items():
                if case not in found[0]:
                    continue
                moved = rows(found[0][case], values, arguments.beyond)
                told = len(set(values) - set(found[0][case]))
                print(f"{case}: {len(moved)} of {len(found[0][case])} moved, {told} new\n")
                if moved:
                    print("\n".join(["| scalar | before | after | by |", "|---|---|---|---|", *moved]), "\n")


if __name__ == "__main__":
    main()
