"""``cyclo init``: a commented drive file to start from."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from ltca.errors import CycloError, DriveError, shortened
from ltca.reading.arguments import SHIPPED_DRIVES, path_argument

SUMMARY = (
    "write a commented drive file to start from: the paper's drive, a robot joint's, an RV reducer's, one of loose pins"
)
EXAMPLES = (
    ("cyclo init my.toml", "the file of the paper's drive, commented"),
    ("cyclo init joint.toml --like robot-joint", "two discs, the housing held"),
)


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", metavar="FILE", type=path_argument("FILE"), help="TOML file to write, e.g. my.toml")
    parser.add_argument(
        "--like",
        choices=SHIPPED_DRIVES,
        default="paper",
        help="the paper's drive: one disc, pin shaft held (default); or made up: a robot joint's, two discs, housing held; an RV "
        "reducer's, two discs on three cranks; wheel pins loose in slots and sleeves on the output pins",
    )
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")


def execute(arguments: argparse.Namespace) -> int:
    """Write the file."""
    from ltca.drive.names import NAMING, names_a_file
    from ltca.output.files import whole_file
    from ltca.output.terminal import shell_words
    from ltca.reading.drive_file import shipped_drive

    path: Path = arguments.file
    if not names_a_file(path.stem):
        raise DriveError([f"{shortened(str(path))}: the drive is named after the file, and its name {NAMING}"])
    if path.is_dir():
        raise CycloError(f"{path}: is a folder, not a file")
    if path.exists() and not arguments.force:
        raise CycloError(f"{path}: exists already; --force overwrites it")
    if path.exists() and not path.is_file():  # a device would be replaced by a file
        raise CycloError(f"{path}: is no regular file, nothing is written in its place")
    own = f"name = {json.dumps(path.stem, ensure_ascii=False)}"
    text = shipped_drive(arguments.like).replace(f'name = "{arguments.like}"', own, 1)
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
    word = shell_words([str(path)])
    print(f"{path}: written; to check it:\n  cyclo show {word}\nto analyse it:\n  cyclo run {word}")
    return 0
