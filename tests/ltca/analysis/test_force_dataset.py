"""Dataset of the spectra of forces: each order of each part stands where its dimensions say."""

import numpy as np

from ltca.analysis.engines import HalfSpace
from ltca.analysis.force_dataset import NAMES, force_dataset
from ltca.analysis.vibration import vibration
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


def test_amplitudes_and_phases_by_order():
    """mean + Σ a cos(o φ − phase) of a part is the force that the spectrum gives at an angle."""
    drive = with_fields(load_drive("paper").cases["CS-1"], {"inertia.output": 0.5, "damping.ratio": 0.05})
    found = vibration(drive, engine=HalfSpace(), positions=4, turns=4, torque_parts=())
    data = force_dataset(found, None).to_xarray().isel(speed=0)
    angle, seen = 0.7, 0
    for one in found.forces:
        name, orders = NAMES[one.kind]
        amplitude, phase = (data[f"{name}_order_{what}"] for what in ("amplitude", "phase"))
        assert amplitude.dims[-1] == orders
        waves = amplitude * np.cos(data[orders] * angle - phase)
        told = (data[f"{name}_over_speed"] + waves.sum(orders)).values
        expected = one.mean + np.tensordot(np.exp(1j * one.orders * angle), one.amplitude, axes=(0, 0)).real
        np.testing.assert_allclose(told, expected, rtol=0.0, atol=1e-5 * np.abs(one.mean).max())
        seen += 1
    assert seen >= 4
