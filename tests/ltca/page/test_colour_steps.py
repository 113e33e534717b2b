"""Pressures have the same colours on pages that scripts draw and on those that are drawn beforehand."""

import re
from importlib import resources


def test_the_steps_of_style_and_script_agree():
    own = resources.files("ltca.page")
    script = (own / "scripts" / "svg.js").read_text(encoding="utf-8")
    style = (own / "templates" / "study.css").read_text(encoding="utf-8")
    steps = re.findall(r"#[0-9a-f]{6}", re.search(r"CIVIDIS = \[(.*?)\]", script)[1])
    light, dark = (re.findall(r"--p\d: (#[0-9a-f]{6});", line) for line in style.splitlines() if "--p0:" in line)
    assert light == steps
    assert dark == steps[::-1]  # the further from the ground of the page, the more
