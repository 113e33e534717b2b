"""Faults around files and processes as they happen: what was tried, what went right, what went wrong.

python benchmarks/file_faults.py kills [--kills 20] [--commands run fem …] [--signal KILL | TERM]
python benchmarks/file_faults.py discs
python benchmarks/file_faults.py folders
python benchmarks/file_faults.py clusters
"""

from __future__ import annotations

import argparse
import sys

from fault_kinds import clusters, discs, folders, kills

KINDS = {"kills": kills, "discs": discs, "folders": folders, "clusters": clusters}


def main() -> int:
    """Run one kind of faults."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    kinds = parser.add_subparsers(metavar="KIND", required=True)
    for name, module in KINDS.items():
        command = kinds.add_parser(name, help=module.__doc__)
        module.configure(command)
        command.set_defaults(execute=module.execute)
    arguments = parser.parse_args()
    return int(arguments.execute(arguments))


if __name__ == "__main__":
    sys.exit(main())
