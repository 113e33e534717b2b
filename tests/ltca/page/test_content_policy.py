"""Pages run their own script and nothing else: the content security policy, in a page's text and in a real browser."""

from __future__ import annotations

import base64
import hashlib
import re

import pytest

from ltca.page.study_page import StudyPage, study_page

SEEN = """<script>addEventListener("load", () => setTimeout(() => { seen.ran = window.ran === 1; leave(); }, 200));</script>"""
INJECTED = (
    "<script>window.ran = 1</script><img src=x onerror='window.ran = 1'><b onclick='window.ran = 1' id='hit'>x</b>"
)


def page():
    return study_page(StudyPage(name="a", told="b", sections=[]))


def test_a_page_names_the_hashes_of_its_script_and_style():
    text = page()
    policy = re.search(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)">', text).group(1)
    assert "unsafe" not in policy
    assert policy.startswith("default-src 'none'; ")
    for element in ("script", "style"):
        (content,) = re.findall(rf"<{element}>(.*?)</{element}>", text, re.S)
        known = base64.b64encode(hashlib.sha256(content.encode()).digest()).decode()
        assert f"{element}-src 'sha256-{known}'" in policy
    # Before anything that it is to hold for.
    assert text.index("Content-Security-Policy") < min(text.index("<title>"), text.index("<style>"))
    assert not re.search(r"<[^>]* (style|on[a-z]+)=", re.sub(r"<script.*?</script>", "", text, flags=re.S))


@pytest.mark.needs("chromium")
@pytest.mark.slow
@pytest.mark.parametrize("injected", ["", INJECTED])
def test_a_script_in_a_page_that_is_not_its_own_does_not_run(injected, chromium, tmp_path):
    """Pages had no content security policy."""
    text = page().replace("<main", injected + "<main", 1)
    seen, console, asked = chromium(text, SEEN, tmp_path)
    assert seen["ran"] is False
    assert asked == set()
    told = [line for line in console if "Content Security Policy" in line]
    assert bool(told) == bool(injected)
    assert console == told
    # Without the policy it would: the test can fail.
    seen, _, _ = chromium(re.sub(r"<meta http-equiv[^>]*>", "", text), SEEN, tmp_path)
    assert seen["ran"] is bool(injected)
