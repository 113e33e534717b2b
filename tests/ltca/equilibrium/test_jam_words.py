"""What is said where the balance ends before the whole friction counts."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from ltca.analysis.engines import HalfSpace
from ltca.drive.parts import Friction
from ltca.equilibrium import output_torque
from ltca.errors import ConvergenceError
from ltca.reading.drive_file import load_drive


def test_a_balance_that_is_lost_without_growing_loads_is_no_jam(monkeypatch):
    """A search that fails from 0.4 of the friction on, where the loads have hardly grown: nothing shows that the drive jams."""
    drive = replace(load_drive("paper").cases["CS-2"], friction=Friction(pin=0.05))
    solve = output_torque.solve_equilibrium

    def lost(model, *arguments, **options):
        if model.friction is not None and model.friction.strength > 0.4:
            raise ConvergenceError("lost")
        return solve(model, *arguments, **options)

    monkeypatch.setattr(output_torque, "solve_equilibrium", lost)
    with pytest.raises(ConvergenceError, match="no balance was found between") as caught:
        output_torque.solve_at_output(HalfSpace().prepare(drive).model, [drive], np.array([0.3]), drive.load.torque)
    told = re.search(r"friction.pin = (\S+) to (\S+) of 0.05", str(caught.value)).groups()
    least, most = (float(part) / 0.05 for part in told)
    # A step is halved until it is at most a hundredth, and told with three digits.
    assert 0.4 - 0.011 < least <= 0.4 < most < 0.4 + 0.011
