"""Parts of the cases of solid pairs that need no mesh."""

from __future__ import annotations

import pytest

from validation.manual.solid_pairs import LINE_LOAD, press_images


@pytest.mark.slow
def test_the_line_on_half_spaces_with_images_carries_the_load_of_the_case():
    solved = press_images(4)
    # The approach is found to 1e-7 mm of some hundredths.
    assert solved.load == pytest.approx(LINE_LOAD, rel=1e-4)
