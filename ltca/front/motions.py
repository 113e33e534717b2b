"""`ltca.motion`: a run in time of ``cyclo dynamics --time`` on one drive."""

from __future__ import annotations

from pathlib import Path

from ltca.analysis.engines import Engine
from ltca.analysis.time_run import Course, TimeRun, prepare_run, run_in_time
from ltca.compliance.coefficients import InfluenceCoefficients
from ltca.drive.parts import Drive
from ltca.drive.units.quantities import parse_quantity
from ltca.errors import DriveError
from ltca.front.arguments import counted, engine_given, require_drive
from ltca.output.threads import on_one_thread
from ltca.reading.arguments import refuse_impossible_torques

MOST_SAMPLES = 1_000_000


@on_one_thread
def motion(
    drive: Drive,
    time: float | str,
    *,
    speed: float | str | None = None,
    kind: str = "steady",
    driven_by: str = "speed",
    within: float | str | None = None,
    at: float | str | None = None,
    from_speed: float | str | None = None,
    factor: float | None = None,
    amplitude: float | None = None,
    frequency: float | str | None = None,
    samples: int | None = None,
    compliance: str | Engine | None = None,
    coefficients: InfluenceCoefficients | Path | str | None = None,
    hole_near_field: bool | None = None,
    bodies: str | None = None,
) -> TimeRun:
    """Run a drive in time on the laws of its contacts.

    Parameters
    ----------
    drive : Drive
        One case of a drive file, every density known.
    time : float or str
        How long, s, or a text with a unit, ``"200 ms"``.
    speed : float or str, optional
        Of the input, turns a minute; ``load.speed`` by default.
    kind : {"steady", "start", "ramp", "step", "reverse", "sine"}
        Evenly under the load; from rest; from one speed to the other; the torque changes by a factor, or its sign; it swings.
    driven_by : {"speed", "torque"}
        Whether the input turns as told, or ``inertia.input`` is driven by the even torque that balances load and friction in the
        mean of a turn.
    within, at : float or str, optional
        Time that start, step or reverse takes, a tenth of the whole by default, and when it begins, half of it; s.
    from_speed : float or str, optional
        First speed of a ramp, turns a minute; 0 by default.
    factor : float, optional
        Torque after a step by that before; 2 by default.
    amplitude : float, optional
        Of the torque of a sine by the load; 0.5 by default.
    frequency : float or str, optional
        Of the torque of a sine, Hz.
    samples : int, optional
        Samples that are kept; 720 to a turn of the crank by default, up to 40 000.
    compliance : {"half-space", "fe", "hybrid"} or engine, optional
        How the bodies yield; left out, ``drive.analysis.compliance`` says it: ``hybrid`` unless the drive file has another.
    coefficients : InfluenceCoefficients or path, optional
        Of the bodies, for ``fe`` and ``hybrid``; found in the cache or derived when left out.
    hole_near_field : bool, optional
        Whether hole walls yield like a Hertz contact (``fe`` and ``hybrid``); they do by default.
    bodies : {"plane", "solid"}, optional
        What bodies the coefficients of ``fe`` and ``hybrid`` are of: plane sections, or solids with their ends; left out,
        ``drive.analysis.bodies`` says it.

    Returns
    -------
    TimeRun
        With ``samples``, ``transmission_error``, ``energy`` and ``spectrum()``.

    Raises
    ------
    DriveError
        For what the motion does not take or a run in time leaves out, by name.
    ConvergenceError
        Where no balanced state is found to start from, or the solver's step vanishes.

    Examples
    --------
    >>> import ltca
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> run = ltca.motion(drive, "0.1 ms", speed=1500, samples=5, compliance="half-space")
    >>> bool(abs(run.energy.relative) < 1e-5)
    True
    """
    require_drive(drive)
    refuse_impossible_torques([drive])

    def given(value: float | str | None, unit: str, name: str) -> float | None:
        return parse_quantity(value, unit, name) if isinstance(value, str) else value

    turns = given(speed, "rpm", "speed")
    turns = drive.load.speed if turns is None else turns
    if turns is None:
        raise DriveError(["speed: must be given for a run in time (or load.speed in the drive file), rpm"])
    course = Course.of_values(
        kind,
        float(given(time, "s", "time") or 0.0),
        turns,
        driven_by,
        within=given(within, "s", "within"),
        at=given(at, "s", "at"),
        from_speed=given(from_speed, "rpm", "from_speed"),
        factor=factor,
        amplitude=amplitude,
        frequency=given(frequency, "Hz", "frequency"),
    )
    engine = engine_given(drive, compliance, coefficients=coefficients, hole_near_field=hole_near_field, bodies=bodies)
    kept = None if samples is None else counted(samples, "samples", 2, MOST_SAMPLES)
    return run_in_time(prepare_run(drive, engine, course), samples=kept)
