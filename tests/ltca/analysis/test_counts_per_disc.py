"""Counts of loaded contacts are those of one disc, or of one crank bearing, whatever the number of discs and cranks."""

from __future__ import annotations

import numpy as np
import pytest

from ltca.analysis.loaded_analysis import analyse
from ltca.analysis.summary import summarise_cases
from ltca.commands.actions.run_table import run_table
from ltca.geometry.placement import position_angles
from ltca.quantities import LIMITED, SCALARS
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive

COUNTS = ("mean_loaded_pins", "mean_loaded_rollers", "mean_loaded_pin_shaft_pins")


def summary_of(analysis):
    (found,) = summarise_cases({"": analysis}, without_load=False).values()
    return found


@pytest.mark.slow
def test_two_discs_were_summed_in_the_contact_ratio():
    """Each of two discs carries about half of the torque, with as many contacts as one disc alone; the sum was twice that."""
    drive = load_drive("paper").cases["CS-6"]
    one = with_fields(drive, {"load.torque": 0.5 * drive.load.torque})
    two = with_fields(drive, {"disc.number_of_discs": 2})
    angles = position_angles(2)
    alone = summary_of(analyse(one, angles))
    found = summary_of(analyse(two, angles))
    # The second disc is elsewhere in the mesh, and the discs share the torque not quite evenly: less than one contact.
    for name, count in zip(COUNTS, (14, 11, 8), strict=True):
        assert found[name] == pytest.approx(alone[name], abs=1.0), name
        assert 0.0 < found[name] <= count


@pytest.mark.slow
def test_counts_are_means_of_those_of_discs_and_bearings():
    """Counted part by part from the loads of the RV's two discs on three cranks."""
    drive = load_drive("rv").cases["nominal"]
    analysis = analyse(drive, position_angles(3))
    found, contacts = summary_of(analysis), analysis.full.response
    discs, cranks = drive.disc.number_of_discs, drive.crank.number
    assert discs == 2
    assert cranks > 1
    for name, load, parts in (
        ("mean_loaded_pins", contacts.pin_load, discs),
        ("mean_loaded_rollers", contacts.rollers.outer_load, discs * cranks),
    ):
        each = np.split(load > 1e-3 * load.max(), parts, axis=1)
        assert found[name] == pytest.approx(np.mean([part.sum(axis=1) for part in each]))
    assert found["mean_loaded_pin_shaft_pins"] is None


def test_rows_say_of_what_the_counts_are():
    assert LIMITED["mean_loaded_pins"].verdict_title == "contact ratio: loaded wheel pins per disc"
    titles = [SCALARS[name].title for name in COUNTS]
    assert titles == [
        "loaded wheel pins per disc, mean",
        "loaded rollers per crank bearing, mean",
        "loaded shaft pins per disc, mean",
    ]
    drive = load_drive("paper").cases["CS-6"]
    analysis = analyse(drive, position_angles(1))
    table = run_table({"": analysis}, {"": summary_of(analysis)}, {}, {})
    for words in ("wheel pins per disc", "rollers per bearing", "shaft pins per disc"):
        assert words in table
