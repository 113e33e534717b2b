"""Reduce a drive for ``cyclo export --for``, write its files, print how good it is."""

from __future__ import annotations

import sys
import time
from pathlib import Path

from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.half_space_errors import half_space_words
from ltca.analysis.reduced_model.model import NEWTON_METRE, ReducedModel, largest_speed, positions_of, reduce_drive
from ltca.analysis.time_need import TOLD_FROM
from ltca.compliance.coefficient_files import told_seconds
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import ARCMIN
from ltca.dynamics.masses import drive_masses
from ltca.export.simulators.files import file_names, require_exportable, write_simulator
from ltca.output.progress import progress

WIDE_FIT = 2.0
"""Error of the fit, % of the torque range, beyond which a warning is printed."""


class TimeNeed:
    """Time of the whole by that of the second part that is solved: the first one starts from nothing and takes longer.

    Parameters
    ----------
    total : int
        Positions of the whole.
    """

    def __init__(self, total: int) -> None:
        self.total, self.parts, self.began = total, 0, time.perf_counter()

    def after(self, size: int) -> float | None:
        """Return the seconds of the whole when the second part of so many positions is solved, and they are many; else None."""
        self.parts, before = self.parts + 1, self.began
        self.began = time.perf_counter()
        seconds = (self.began - before) / size * self.total
        return seconds if self.parts == 2 and seconds > TOLD_FROM else None


def check_drive(kind: str, drive: Drive) -> None:
    """Refuse what a format needs and the drive does not say, before anything is solved."""
    drive.require_torque("a reduced model, whose tables go up to it")
    require_exportable(kind, largest_speed(drive), drive_masses(drive).without_density)


def reduce_and_write(kind: str, drive: Drive, engine: Engine, name: str, out: Path) -> int:
    """Reduce a drive, write the files of a format, print the results; return the exit status."""
    total = positions_of(drive)
    expected = TimeNeed(total)
    with progress("positions", total, at_most=drive.friction is not None) as advance:

        def solved(size: int) -> None:
            advance(drive.case, size)
            if seconds := expected.after(size):
                print(
                    f"the model takes {told_seconds(seconds)} in all ({total} positions)", file=sys.stderr, flush=True
                )

        found = reduce_drive(drive, engine, solved)
    remarks = write_simulator(kind, {"name": name, **found.content}, out)
    print("\n".join(_lines(found)))
    single, mean = (_part_of_range(found, torque) for torque in (found.worst.torque, found.worst.mean_torque))
    if single > WIDE_FIT:
        told = f"error of the fit beyond {WIDE_FIT:g} %: {single:.3g} % of the torque range at single crank angles"
        told += f", {mean:.2g} % of their mean"
        print(f"warning: {told}; simulate with the model only what may be off by that much", file=sys.stderr)
    for remark in remarks:
        print(f"  {remark}")
    for file in file_names(kind, name):
        print(f"  written: {out / file}")
    return 0


def _lines(found: ReducedModel) -> list[str]:
    drive, table, worst, friction = found.drive, found.wind_up, found.worst, found.friction
    lines = [
        f"{drive.name} {drive.case}, {drive.load_words()}, {describe_engine(found.engine)}: reduced model to "
        f"{found.largest / NEWTON_METRE:.6g} N·m either way",
        *(f"  {words}" for words in [half_space_words(found.engine, drive)] if words),
        f"  play {table.play * ARCMIN:.4g}′, spring behind it {table.stiffness / NEWTON_METRE / ARCMIN:.4g} N·m/′, "
        f"{len(table.orders)} orders of the transmission error over {table.turns} turns",
    ]
    if drive.friction is not None:
        back = friction.driving_back_torque(1.0)
        told = (
            "no load of the output moves the input"
            if back is None
            else f"driven back from {back / NEWTON_METRE:.4g} N·m"
        )
        lines.append(
            f"  hysteresis of {found.elements.strength.size} Maxwell-slip elements; {told}; efficiency "
            f"{friction.efficiency[-1]:.4g} at the largest torque"
        )
    else:
        lines.append("  neither hysteresis nor friction: the drive file has no [friction]")
    lines.append(
        f"  error of the fit at {worst.points} points: {_part_of_range(found, worst.torque):.3g} % of the torque range, "
        f"{worst.angle * ARCMIN:.2g}′; of the mean over crank angles {_part_of_range(found, worst.mean_torque):.2g} %, "
        f"{worst.mean_angle * ARCMIN:.2g}′, scatter over them {_part_of_range(found, worst.scatter_torque):.2g} %, "
        f"{worst.scatter_angle * ARCMIN:.2g}′"
    )
    return lines


def _part_of_range(found: ReducedModel, torque: float) -> float:
    """Error of the fit, N·mm, in % of the range from one end of the tables to the other."""
    return 50.0 * torque / found.largest
