"""The verdict on one drive: its checks, what drives each value and would mend what fails, and what to know beside them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import log

from ltca.analysis.engines import Engine, describe_engine
from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise
from ltca.analysis.verdict.advice import MAX_INPUTS, Driver, advise
from ltca.analysis.verdict.assembly import play_at_temperature
from ltca.analysis.verdict.lead_crown import best_lead_crown
from ltca.analysis.verdict.values import judge_analysis, notes as notes_of
from ltca.drive.members.judgement import WHOLE, Check, Value, judge
from ltca.drive.members.limits import Limit
from ltca.drive.members.temperatures import warm_drive
from ltca.drive.members.verdict_words import is_of_sampling, urgency, verdict_table
from ltca.drive.parts import Drive
from ltca.errors import OverloadError
from ltca.geometry.placement import position_angles

ADVICE_POSITIONS = 60
"""Positions at which changed drives are compared."""
OFFSET = 1e-3
LEAST_PART = 1e-3
"""Part of the torque below which it is not tried whether the drive carries it."""


@dataclass(frozen=True, kw_only=True, repr=False, eq=False)
class DriveCheck:
    """Verdict on one drive.

    Attributes
    ----------
    drive : Drive
        What was judged, as it was given.
    engine : Engine
        What it was analysed on.
    positions : int
        Positions of a turn of the crank.
    torque : float
        Output torque, N·mm.
    checks : tuple of Check
        A value, its limit and the verdict each, in the order of the table.
    drivers : mapping of str to sequence of Driver
        Inputs that drive the value of a quantity, the strongest first, and what would mend it; empty without advice.
    notes : tuple of str
        What to know beside the checks, one sentence each.

    Examples
    --------
    >>> import ltca
    >>> file = ltca.load_drive("paper")
    >>> found = ltca.check(file, 28, case="CS-1", limits={"max_pin_load": "1 kN"}, advice=False)
    >>> found.passes, [check.value.quantity for check in found.failed], found["pin_load"].verdict
    (False, ['pin_load'], 'fail')
    >>> print(found.advice.strip())
    largest load of a wheel pin fails (limit: [limits], no source given)
    """

    drive: Drive
    engine: Engine
    positions: int
    torque: float
    checks: tuple[Check, ...]
    drivers: Mapping[str, Sequence[Driver]]
    notes: tuple[str, ...]

    @property
    def failed(self) -> tuple[Check, ...]:
        """The checks that fail."""
        return tuple(check for check in self.checks if check.fails)

    @property
    def passes(self) -> bool:
        """Whether no check fails."""
        return not self.failed

    def __getitem__(self, quantity: str) -> Check:
        """Return the check of a quantity, ``check["pin_pressure_mid"]``: of several that which fails, else the first."""
        found = [check for check in self.checks if check.value.quantity == quantity]
        if not found:
            raise KeyError(quantity)
        return next((check for check in found if check.fails), found[0])

    @property
    def heading(self) -> str:
        """Drive, load, engine and positions in one line."""
        return (
            f"{self.drive.name} {self.drive.case}, {self.drive.load_words(self.torque)}: judged by "
            f"{describe_engine(self.engine)}, {self.positions} positions"
        )

    def __repr__(self) -> str:
        """Print the checks as a table, the notes and the advice."""
        rows = [self.heading, verdict_table(self.checks), *(f"  note: {note}" for note in self.notes), self.advice]
        return "\n".join(rows).rstrip()

    @property
    def advice(self) -> str:
        """What drives the checks that fail and would mend them, as text."""
        lines = []
        for check in sorted(self.failed, key=urgency):
            limit = check.limit
            source = "" if limit is None else f" (limit: {limit.source})"
            told = "fails" if check.verdict == "fail" else f"cannot be judged: {check.value.reason}"
            lines.append(f"  {check.title} {told}{source}")
            if is_of_sampling(check):
                lines.append("    this is a matter of --positions, not of the drive")
            each = self.drivers.get(check.value.quantity, ())
            helping = [driver for driver in each if driver.change]
            lines += [
                f"    {driver.input}: {driver.change} would about do (d ln value/d ln input = {driver.elasticity:+z.2f})"
                for driver in helping[: 2 * MAX_INPUTS]
            ]
            if each and not helping:
                named = ", ".join(f"{driver.input} ({driver.elasticity:+z.2f})" for driver in each[:MAX_INPUTS])
                lines.append(
                    f"    driven by {named}; no single change by a factor of three mends it and keeps the others"
                )
            lines += [
                f"    not {driver.input}: what mends this fails {', '.join(driver.breaks)}"
                for driver in [driver for driver in each if driver.breaks][:MAX_INPUTS]
            ]
        return "".join(f"{line}\n" for line in [*lines, *_at_once(self.failed, self.drivers)])


def check_drive(
    drive: Drive,
    limits: Mapping[str, Limit],
    engine: Engine,
    *,
    positions: int,
    torque: float | None = None,
    advice: bool = True,
) -> DriveCheck:
    """Return the verdict on a drive against the limits of its file, at an output torque in N·mm, the drive's own by default.

    A torque that cannot be carried fails, and the other checks are those at the part that can.
    """
    used, whole = engine.with_coefficients(drive), drive.load.torque if torque is None else torque
    part, refusal = 1.0, ""

    def found(checks: list[Check], drivers: Mapping[str, Sequence[Driver]], notes: list[str]) -> DriveCheck:
        return DriveCheck(
            drive=drive, engine=engine, positions=positions, torque=whole,
            checks=tuple(checks), drivers=drivers, notes=tuple(notes),
        )  # fmt: skip

    while True:
        try:
            analysis = analyse(drive, position_angles(positions), part * whole, used)
            break
        except OverloadError as error:
            # Contacts wider than the bodies are curved: less of the torque tells how far it is from being carried.
            if part < LEAST_PART and drive.temperature is not None:
                return found(_seized(drive, limits), {}, [*error.problems])
            if part < LEAST_PART:
                raise
            part, refusal = 0.5 * part, refusal or error.problems[0]
    checks = judge_analysis(analysis, summarise(analysis), limits)
    told = notes_of(analysis)
    if refusal:
        checks.insert(0, Check(value=Value(quantity="carried_torque", value=part), limit=WHOLE))
        told.insert(
            0,
            f"{refusal}; the checks are those at {part:g} of the torque. All sizes × {part ** (-1.0 / 3.0):.3g} would about "
            "carry the whole: at equal stress torques grow with the cube of the size",
        )
    if not advice:
        return found(checks, {}, told)
    if engine.compliance != "half-space" and any(check.fails for check in checks):
        told.append("what drives each value is found on half-spaces, whatever judges it")
    if drive.contact.slices > 1:
        crown = best_lead_crown(drive, part * whole)
        if crown is not None and crown.words:
            told.append(crown.words)
    # Between those of a turn, so that nothing is refined.
    angles = position_angles(min(positions, ADVICE_POSITIONS)) + OFFSET
    return found(checks, advise(drive, checks, angles, whole, part), told)


def _at_once(failed: Sequence[Check], drivers: Mapping[str, Sequence[Driver]]) -> list[str]:
    """Changes of one input that mend all failed checks together: of each input that mends every one, the largest change."""
    helping = [drivers.get(check.value.quantity, ()) for check in failed if not is_of_sampling(check)]
    if len(helping) < 2:
        return []
    each = [{driver.input: driver for driver in one if driver.factor is not None} for one in helping]
    common = [name for name in each[0] if all(name in one for one in each)]
    farthest = [max((one[name] for one in each), key=lambda driver: abs(log(driver.factor or 1.0))) for name in common]
    told = "; ".join(f"{driver.input}: {driver.change}" for driver in farthest)
    return [f"  all of them at once: {told}"] if told else []


def _seized(drive: Drive, limits: Mapping[str, Limit]) -> list[Check]:
    """Checks of a drive whose parts thermal growth presses together beyond what they carry: those known without a solution."""
    carried = Check(value=Value(quantity="carried_torque", value=0.0), limit=WHOLE)
    return [carried, *judge(drive, list(play_at_temperature(drive, warm_drive(drive))), limits)]
