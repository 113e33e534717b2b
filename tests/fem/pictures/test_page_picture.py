"""Pictures of a page: a clear ground, words in the colours of the page, names as texts."""

from __future__ import annotations

import base64
import io
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from PIL import Image

from fem.pictures.offscreen import rendering_problem
from fem.pictures.page_picture import panel_svg
from fem.pictures.scene import Panel, Triangles, paint_panels


@pytest.fixture
def panel(monkeypatch):
    """The unit square in the middle of a window twice as wide."""
    monkeypatch.setenv("CYCLO_NO_PYVISTA", "1")
    rendering_problem.cache_clear()
    corners = np.array([0.0, 1.0, 1j, 1.0 + 1j])
    patch = Triangles(points=corners, faces=np.array([[0, 1, 2], [1, 3, 2]]), values=np.arange(4.0))
    yield Panel(
        title='a "<b>" & c',
        centre=0.5 + 0.5j,
        half_side=1.0,
        triangles=(patch,),
        lines=(),
        label="value",
        limits=(0.0, 3.0),
    )
    rendering_problem.cache_clear()


def test_pictures_of_a_dark_page_are_not_white(panel):
    """The ground is clear, so that it is the page's own, and so are words, whose colours are classes."""
    (image,) = paint_panels([panel], 80)
    clear = image[:, :, 3] == 0
    assert image.shape == (80, 80, 4)
    # The square covers a quarter of the window; its edges a row of pixels on every side
    assert abs(clear.mean() - 0.75) <= (42.0**2 - 40.0**2) / 80.0**2 + 1e-12
    assert not clear[24:56, 24:56].any()
    drawn = ElementTree.fromstring(panel_svg(panel, image, 40))
    assert {text.get("class") for text in drawn.iter("text")} == {"stress-text"}
    assert not [text for text in drawn.iter("text") if text.get("fill") or text.get("style")]
    (kept,) = drawn.iter("image")
    found = base64.b64decode(re.sub("^data:image/webp;base64,", "", kept.get("href")))
    with Image.open(io.BytesIO(found)) as opened:
        assert (opened.size, opened.mode) == ((40, 40), "RGBA")
        assert opened.getpixel((1, 1))[3] == 0


def test_ticks_stand_at_their_values(panel):
    """Two units of the window are the field's side: ticks of x and y, and of the scale from 0 to 3."""
    drawn = ElementTree.fromstring(panel_svg(panel, *paint_panels([panel], 40)))
    field = next(drawn.iter("image"))
    left, side = float(field.get("x")), float(field.get("width"))
    assert drawn.get("aria-label") == panel.title
    along = [
        text for text in drawn.iter("text") if text.get("text-anchor") == "middle" and re.match(r"[−\d]", text.text)
    ]
    assert len(along) >= 4
    for text in along:
        value = float(text.text.replace("−", "-"))
        assert float(text.get("x")) == pytest.approx(
            left + side * (value + 0.5) / 2.0, abs=0.06
        )  # a digit behind the point
