"""The table of ``cyclo fem --referee``: both answers and their differences, without running either code."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

import fem.referee.calculix as calculix
from fem.referee.calculix import RefereeAnswer, compare_with_calculix
from fem.referee.calculix_deck import pair_name


def detail(load, peak):
    return SimpleNamespace(load=load, peak_pressure=peak)


def test_table_of_both_answers(monkeypatch, tmp_path):
    pairs = [
        SimpleNamespace(kind=kind, index=index) for kind, index in (("pin", 3), ("pin", 4), ("hole", 1), ("pin", 9))
    ]
    solution = SimpleNamespace(
        model=SimpleNamespace(pairs=pairs),
        contacts=SimpleNamespace(
            details=[detail(2000.0, 1010.0), detail(500.0, 400.0), detail(800.0, 300.0), detail(0.0, 0.0)]
        ),
        pose=SimpleNamespace(wheel_angle=-2.0e-3),
        seconds={"total": 12.34},
    )
    names = [pair_name(pair) for pair in pairs]
    answer = RefereeAnswer(
        load={names[0]: 1990.0, names[1]: 505.0},
        peak_pressure={names[0]: 1000.0, names[1]: 400.0},
        wheel_angle=-2.0e-3 - np.radians(0.25 / 3600.0),
        seconds=99.0,
    )
    monkeypatch.setattr(calculix, "write_deck", lambda solution, path: path)
    monkeypatch.setattr(calculix, "ask_calculix", lambda *words: answer)
    lines = compare_with_calculix(solution, tmp_path / "calculix.inp", "ccx")
    rows = {line[:16].strip(): line[16:].split() for line in lines[2:-2]}
    # change of a load as a part of the largest of its kind, rise of the peak; open in both: not listed
    assert rows == {
        names[0].lower(): ["2000.00", "1990.00", "0.500", "1010.0", "1000.0", "1.00"],
        names[1].lower(): ["500.00", "505.00", "-0.250", "400.0", "400.0", "0.00"],
        names[2].lower(): ["800.00", "0.00", "100.000", "300.0", "0.0"],
    }
    assert '(+0.250")' in lines[-2]
    assert lines[-1] == "seconds: 12.3, ccx 99.0"
