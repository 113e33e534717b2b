"""The plan of a validation: what cannot be compared is refused before any work."""

from dataclasses import replace

from refusals import refused_field

import validation.study as study
from fem.options import SolutionOptions
from ltca.reading.changes import with_fields
from ltca.reading.drive_file import load_drive


def test_what_full_fe_cannot_say_is_refused_before_any_work():
    file = load_drive("paper")
    short = with_fields(file.cases["CS-1"], {"crank_bearing.roller_length": 8.0})
    with refused_field("crank_bearing.roller_length", "= 8 mm", bound=("equal to", 11.8)):
        study.plan_study(replace(file, cases={"short": short}), None, None, "quick", SolutionOptions())
