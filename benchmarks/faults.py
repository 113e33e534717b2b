"""Fault injection: malformed input, killed processes, full disks, concurrent runs and cluster failures.

python benchmarks/faults.py malformed [--count 1000] [--seed 1]
python benchmarks/faults.py kills [--kills 20] [--commands run fem …] [--signal KILL | TERM]
python benchmarks/faults.py discs
python benchmarks/faults.py folders
python benchmarks/faults.py clusters
"""

from __future__ import annotations

import argparse
import sys

from fault_kinds import clusters, discs, folders, kills, malformed

KINDS = {"malformed": malformed, "kills": kills, "discs": discs, "folders": folders, "clusters": clusters}


def main() -> int:
    """Run the trials of one kind of fault."""
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
