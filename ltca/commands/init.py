"""``cyclo init``: a commented drive file to start from."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

SUMMARY = "write a commented copy of the paper's drive to start from"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("file", metavar="FILE", help="TOML file to write, e.g. my.toml")
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")


def execute(arguments: argparse.Namespace) -> int:
    """Write the file."""
    from ltca.errors import CycloError
    from ltca.output.files import whole_file
    from ltca.reading.drive_file import shipped_drive

    path = Path(arguments.file)
    if path.exists() and not arguments.force:
        raise CycloError(f"{path}: exists already; --force overwrites it")
    text = shipped_drive().replace('name = "paper"', f"name = {json.dumps(path.stem, ensure_ascii=False)}", 1)
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")
    print(f"{path}: written; 'cyclo show {path}' checks it, 'cyclo run {path}' analyses it")
    return 0
