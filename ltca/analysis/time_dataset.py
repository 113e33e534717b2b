"""What a run in time leaves: the dataset ``time.nc``, and the numbers of ``time.json``."""

from __future__ import annotations

from typing import Any

import numpy as np

from ltca.analysis.engines import describe_engine
from ltca.analysis.time_run import EnergyBalance, TimeRun
from ltca.analysis.width import AXES
from ltca.arrays import FloatArray
from ltca.output.labelled import LabelledDataset
from ltca.quantities import SCHEMA_VERSION

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
    wide = ("time", "disc")

    def told(unit: str, words: str) -> dict[str, str]:
        return {"units": unit, "long_name": words}

    places = np.array([motion.pose.columns(disc)[:3] for disc in range(discs)])
    centre = taken.place[:, places]
    data = {
        "crank_angle": ("time", taken.place[:, motion.crank], told("rad", "crank angle against the pin shaft")),
        "wheel_angle": ("time", taken.place[:, motion.wheel_angle], told("rad", "deviation of the wheel from φ_C/u")),
        "transmission_error": ("time", run.transmission_error, told("rad", "transmission error at the output")),
        "input_speed": ("time", run.input_speed, told("rpm", "speed of the input, ccw positive")),
        "input_torque": ("time", taken.input_torque, told("N mm", "external torque at the input, ccw positive")),
        "output_torque": ("time", taken.output_torque, told("N mm", "external torque at the output, ccw positive")),
        "disc_displacement_x": (wide, centre[:, :, 0], told("mm", "displacement of the disc along x")),
        "disc_displacement_y": (wide, centre[:, :, 1], told("mm", "displacement of the disc along y")),
        "disc_rotation": (wide, centre[:, :, 2], told("rad", "rotation of the disc")),
        "pin_load": ((*wide, "pin"), taken.pin_load, told("N", "load of each wheel pin")),
        "roller_load": (
            (*wide, "crank", "roller"),
            taken.roller_load.reshape(-1, discs, cranks, rollers // cranks),
            told("N", "load of each roller in the bore"),
        ),
        "pin_shaft_load": ((*wide, "hole"), taken.hole_load, told("N", "load of each pin of the pin shaft")),
        "bearing_load": ((*wide, "crank"), taken.bearing_load, told("N", "force of each crank bearing")),
        "kinetic_energy": ("time", taken.kinetic, told("N mm", "kinetic energy")),
        "stored_energy": ("time", taken.stored, told("N mm", "energy stored in contacts and supports")),
        "curvature_work": ("time", taken.curvature, told("N mm", "work of changing radii of curvature")),
        "station_work": ("time", taken.stations, told("N mm", "work of contacts that move over the bodies")),
        **{
            f"{name}_work": ("time", taken.works[:, place], told("N mm", words))
            for place, (name, words) in enumerate(
                (
                    ("input", "work done at the input"),
                    ("output", "work done by the output on its load"),
                    ("damping", "work lost in damping"),
                    ("friction", "work lost in friction"),
                )
            )
        },
    }
    coords: dict[str, Any] = {"time": (("time",), taken.time, told("s", "time"))}
    if motion.pose.leans:
        leans = taken.place[:, [motion.pose.columns(disc)[motion.pose.lean_place] for disc in range(discs)]]
        # A tilt is a rotation vector, a lean what x and y change by along z.
        tilt = np.stack((-leans[:, :, 1], leans[:, :, 0]), axis=-1)
        words = "small rotation of the disc about x and y of the frame of the pin shaft"
        data["disc_tilt"] = ((*wide, "axis"), tilt, told("rad", words))
        coords["axis"] = (("axis",), np.array(AXES))
    each: dict[str, tuple[Any, ...]] = {
        name: ((dims,) if isinstance(dims, str) else dims, values, attributes)
        for name, (dims, values, attributes) in data.items()
    }
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
