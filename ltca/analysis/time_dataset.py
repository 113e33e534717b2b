"""What a run in time leaves: the dataset ``time.nc``, and the numbers of ``time.json``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ltca.analysis.engines import describe_engine
from ltca.analysis.time_run import EnergyBalance, TimeRun
from ltca.analysis.width import AXES
from ltca.arrays import FloatArray
from ltca.dynamics.motion import WORKS
from ltca.output.labelled import LabelledDataset
from ltca.quantities import IN_TIME, SCHEMA_VERSION

KINDS = {"pin": "pin_load", "roller": "roller_load", "hole": "hole_load", "crank bearing": "bearing_load"}
"""Loads of `ltca.analysis.time_run.Samples` by what carries them."""
TOLD_ORDERS = 12


def time_dataset(run: TimeRun) -> LabelledDataset:
    """Return the samples of a run as a labelled dataset.

    Parameters
    ----------
    run : TimeRun
        The run.
    """
    taken, motion = run.samples, run.motion
    discs, rollers = taken.pin_load.shape[1], taken.roller_load.shape[2]
    cranks = taken.bearing_load.shape[2]
    places = np.array([motion.pose.columns(disc)[:3] for disc in range(discs)])
    centre = taken.place[:, places]
    data = {
        "crank_angle": taken.place[:, motion.crank],
        "wheel_angle": taken.place[:, motion.wheel_angle],
        "transmission_error": run.transmission_error,
        "input_speed": run.input_speed,
        "input_torque": taken.input_torque,
        "output_torque": taken.output_torque,
        "disc_displacement_x": centre[:, :, 0],
        "disc_displacement_y": centre[:, :, 1],
        "disc_rotation": centre[:, :, 2],
        "pin_load": taken.pin_load,
        "roller_load": taken.roller_load.reshape(-1, discs, cranks, rollers // cranks),
        "pin_shaft_load": taken.hole_load,
        "bearing_load": taken.bearing_load,
        "kinetic_energy": taken.kinetic,
        "stored_energy": taken.stored,
        "curvature_work": taken.curvature,
        "station_work": taken.stations,
        "teeth_work": taken.teeth,
        **{f"{name}_work": taken.works[:, place] for place, name in enumerate(WORKS)},
    }
    coords: dict[str, Any] = {"time": IN_TIME["time"].labelled(taken.time)}
    if motion.pose.leans:
        leans = taken.place[:, [motion.pose.columns(disc)[motion.pose.lean_place] for disc in range(discs)]]
        # A tilt is a rotation vector, a lean what x and y change by along z.
        data["disc_tilt"] = np.stack((-leans[:, :, 1], leans[:, :, 0]), axis=-1)
        coords["axis"] = list(AXES)
    each = {name: IN_TIME[name].labelled(values) for name, values in data.items()}
    attributes = {"schema_version": SCHEMA_VERSION, "engine": describe_engine(run.engine), **run.course.values}
    return LabelledDataset.build(each, coords, attributes)


def time_content(run: TimeRun) -> dict[str, Any]:
    """Return the numbers of a run as ``time.json`` holds them.

    Parameters
    ----------
    run : TimeRun
        The run.
    """
    taken, energy, error = run.samples, run.energy, run.transmission_error
    orders, amplitude = run.spectrum()
    largest = np.argsort(-amplitude, kind="stable")[:TOLD_ORDERS]
    return {
        "motion": run.course.values,
        "samples": int(taken.time.size),
        "damping_ratio": None if run.drive.damping is None else run.drive.damping.ratio_at_resonance,
        "transmission_error_rad": {
            "least": float(error.min()),
            "mean": float(error.mean()),
            "largest": float(error.max()),
        },
        "input_torque_N_mm": _range(taken.input_torque),
        "input_speed_rpm": _range(run.input_speed),
        "largest_load_N": {
            kind.replace(" ", "_"): float(values.max()) for kind, values in loads_by_kind(run).items() if values.size
        },
        "without_contact": run.lost_contact,
        "orders": [
            {"order": float(orders[place]), "amplitude_rad": float(amplitude[place])} for place in sorted(largest)
        ],
        "energy_N_mm": energy_content(energy),
    }


def loads_by_kind(run: TimeRun) -> dict[str, FloatArray]:
    """Return the loads of a run by what carries them, each with the time on axis 0."""
    return {kind: getattr(run.samples, name) for kind, name in KINDS.items()}


def energy_content(energy: EnergyBalance) -> dict[str, float | None]:
    """Return a balance of energy as files hold it; None for what the model does not tell."""
    found = {name: getattr(energy, name) for name in energy.__slots__}
    found |= {"left": energy.left, "left_by_throughput": energy.relative}
    return {name: float(value) if np.isfinite(value) else None for name, value in found.items()}


def _range(values: FloatArray) -> dict[str, float]:
    return {"least": float(values.min()), "mean": float(values.mean()), "largest": float(values.max())}
