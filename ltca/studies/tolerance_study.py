"""Samples drawn from the tolerances of a drive."""

from __future__ import annotations

import json

from ltca.analysis.engines import Engine, engine_of
from ltca.drive.tolerances import Factors
from ltca.errors import DriveError
from ltca.reading.drive_file import DriveFile
from ltca.studies.binding import LARGEST, LEAST, may_bind
from ltca.studies.designs import FEWEST_BLOCKS, ToleranceDesign
from ltca.studies.quantities import check_quantities, quantities_for
from ltca.studies.study import Study
from ltca.studies.yields import limits_of


def tolerance_study(
    file: DriveFile,
    *,
    case: str | None = None,
    samples: int,
    positions: int,
    seed: int = 0,
    sequence: str = "random",
    quantities: tuple[str, ...] | None = None,
    engine: Engine | None = None,
) -> Study:
    """Return the tolerance study of one case of a drive.

    Parameters
    ----------
    file : DriveFile
        Drive with tolerances.
    case : str, optional
        The case; the first by default.
    samples, positions, seed : int
        Samples, crank angles of each over one turn, seed of the random numbers.
    sequence : {"random", "sobol", "saltelli"}
        See `ltca.studies.designs.ToleranceDesign`.
    quantities : tuple of str, optional
        What is kept; by default as `ltca.studies.quantities.quantities_for` says, and what has a limit. The least
        backlash at the output always comes with the largest; where tolerances are as wide as those of prints, samples that
        bind are counted without it.
    engine : Engine, optional
        How bodies yield; half-spaces by default.

    Returns
    -------
    Study

    Raises
    ------
    DriveError
        When the case, a quantity or the tolerances are wrong.
    """
    name = case or next(iter(file.cases))
    drive = file.select([name])[name]
    kept = quantities_for(drive, quantities)
    judged, not_judged = limits_of(drive, file.limits.get(name, {}))
    if quantities is None:  # what has a limit is judged, whatever its solution costs
        kept = (*kept, *(one.quantity for one in judged))
    if LARGEST in kept:  # the least tells which samples bind, and costs nothing beside the largest
        kept = (*kept, LEAST)
    kept = check_quantities(tuple(dict.fromkeys(kept)))
    try:
        factors = Factors.of_tolerances(drive, file.tolerances)
    except DriveError as error:
        of_case = f"case {name}: " if len(file.cases) > 1 else ""
        raise DriveError([of_case + problem for problem in error.problems], file.source) from error
    design = ToleranceDesign(factors=factors, samples=samples, seed=seed, sequence=sequence)
    block = len(design.groups) + 2
    if sequence == "saltelli" and samples < FEWEST_BLOCKS * block:
        raise DriveError(
            [
                f"--samples = {samples}: --design saltelli must have at least {FEWEST_BLOCKS * block}, {FEWEST_BLOCKS} blocks of "
                f"{block} samples for {len(design.groups)} fields that scatter"
            ]
        )
    asked = {"case": name, "samples": samples, "positions": positions, "seed": seed, "design": sequence}
    return Study(
        name=f"{file.name} {name}",
        cases=((name, drive),),
        design=design,
        positions=positions,
        quantities=kept,
        near_nominal=True,
        engine=engine_of(file.cases.values()) if engine is None else engine,
        definition=json.dumps({"study": "tolerances", **asked, "quantities": kept}, ensure_ascii=False),
        drive_file=file.text,
        judged=judged,
        not_judged=not_judged,
        limits=file.limits.get(name, {}),
        counts_binding=LEAST not in kept and may_bind(drive, design),
    )
