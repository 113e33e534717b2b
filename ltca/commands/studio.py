"""``cyclo studio``: a drive in the browser, its answer beside it while its numbers are turned."""

from __future__ import annotations

import argparse
from pathlib import Path

from ltca.errors import CycloError, DriveError, shortened
from ltca.reading.arguments import DRIVE, SHIPPED_DRIVES, add_case_argument, add_drive_argument, count_argument

SUMMARY = "a drive in the browser: turn its numbers and look at loads, pressures and verdict while they change"
EXAMPLES = (
    ("cyclo studio my.toml", "serves a page on this machine alone and opens it; Ctrl-C ends it"),
    ("cyclo studio robot-joint --no-browser", "prints the address alone"),
)
NEEDED = "cyclo studio needs starlette and uvicorn, which are not installed: pip install 'cyclo-ltca[studio]'"


def configure(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add_drive_argument(parser, f"{DRIVE}; default paper", optional=True)
    add_case_argument(parser, "case to start with; default the first", several=False)
    parser.add_argument(
        "--port",
        metavar="N",
        type=count_argument("--port", 0, 65535),
        default=0,
        help="of 127.0.0.1; default 0, a free one",
    )
    parser.add_argument("--no-browser", action="store_true", help="print the address and open no browser")


def execute(arguments: argparse.Namespace) -> int:
    """Serve the page until Ctrl-C."""
    from ltca.reading.drive_file import load_drive

    source = arguments.drive or SHIPPED_DRIVES[0]
    folder = Path.cwd()
    if source not in SHIPPED_DRIVES and not Path(source).resolve().is_relative_to(folder.resolve()):
        raise DriveError([f"{shortened(source)}: must lie in the folder in which the studio is started, or below it"])
    file = load_drive(source)
    (case, *_) = file.select([arguments.case] if arguments.case is not None else None)
    try:
        from ltca.studio.server import Studio, serve
    except ModuleNotFoundError as error:
        if error.name is not None and error.name.partition(".")[0] in ("starlette", "uvicorn", "anyio"):
            raise CycloError(NEEDED) from error
        raise

    def told(address: str) -> None:
        print(f"{file.name}: {address}\nonly this machine can ask it, by that address; Ctrl-C ends it", flush=True)

    try:
        serve(Studio(file.text, source, case, folder), arguments.port, browser=not arguments.no_browser, told=told)
    except KeyboardInterrupt:
        print("studio ended")
    return 0
