"""README and documents: links lead somewhere, examples of the gallery hold a number, set-up lines are those of the CI.

Sphinx checks links between pages when it builds them (``.ci/run``); here what GitHub shows is looked at, without Sphinx.
"""

from __future__ import annotations

import ast
import re
import tomllib
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import needs
import pytest

ROOT = Path(__file__).parents[1]
PAGES = sorted([ROOT / "README.md", *(ROOT / "docs").rglob("*.md")])
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[^)]*)?\)|src=\"([^\"]+)\"")
START, END = "# sphinx_gallery_start_ignore", "# sphinx_gallery_end_ignore"
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def broken(page, text):
    found = [first or second for first, second in LINK.findall(re.sub(r"```.*?```", "", text, flags=re.DOTALL))]
    local = [link for link in found if "://" not in link]
    return [link for link in local if not (page.parent / link).exists()]


@pytest.mark.parametrize("page", PAGES, ids=lambda path: str(path.relative_to(ROOT)))
def test_links_lead_somewhere(page):
    assert broken(page, page.read_text(encoding="utf-8")) == []


def test_a_broken_link_is_seen():
    assert broken(ROOT / "README.md", "[a](docs/nowhere.md), [b](README.md#there)") == ["docs/nowhere.md"]


def headings(page):
    """Anchors of the headings of a page, as hosting pages make them."""
    found = re.findall(r"^#+ (.*)", page.read_text(encoding="utf-8"), flags=re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", text.lower()).replace(" ", "-") for text in found}


def test_links_of_a_checkout_led_to_pages_that_exist_only_after_a_build():
    """Headings of the reference stand for pages of the build, scripts for pages of the gallery; a build leads links to these."""
    spec = spec_from_file_location("generated_pages", ROOT / "docs" / "generated_pages.py")
    pages = module_from_spec(spec)
    spec.loader.exec_module(pages)
    assert set(pages.HEADINGS) <= headings(ROOT / "docs" / "reference" / "index.md")
    seen = set()
    for page in PAGES[1:]:
        name = page.relative_to(ROOT / "docs").with_suffix("").as_posix()
        built = pages.built_links(name, page.read_text(encoding="utf-8"))
        for link in re.findall(r"\]\(([^)\s]*(?:generated|gallery)/[^)\s]+)\)", built):
            seen.add((page.parent / link).resolve().relative_to(ROOT / "docs").as_posix())
    generated = {f"reference/generated/{name}.md" for name in pages.HEADINGS.values()}
    gallery = {"gallery/index.rst", *(f"gallery/{example.stem}.rst" for example in EXAMPLES)}
    assert generated <= seen <= generated | gallery
    assert {"gallery/index.rst", "gallery/own_coefficients.rst"} <= seen


def test_every_page_has_one_title():
    for page in PAGES:
        text = re.sub(r"```.*?```", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
        assert len(re.findall(r"^# ", text, flags=re.MULTILINE)) == 1, page


def test_set_up_lines_are_those_of_the_ci():
    """The two lines that install, to the letter."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    lines = re.findall(r"```sh\n(.*)\n```", text)[:2]
    set_up = "sh .ci/system-libraries && python3 -m venv .venv && .venv/bin/pip install --quiet --editable "
    assert lines == [
        f"{set_up}. && .venv/bin/cyclo run paper",
        f"{set_up}'.[test]' && .venv/bin/python -m pytest -n 2",
    ]


def test_getting_started_called_what_its_line_installs_everything():
    """`cyclo studio`, which the page leads to, needs an extra."""
    page = (ROOT / "docs" / "start" / "index.md").read_text(encoding="utf-8")
    assert "installs everything" not in page
    installed = page[page.index("\n## Installation") : page.index("\n## Write a drive file")]
    assert "`cyclo studio`" in installed
    assert "pip install --editable '.[studio]'" in installed
    assert "`.[studio]`" in page[page.index("\n## Turn numbers and look") :]


def test_the_ci_ends_with_the_test_line_in_a_fresh_clone_with_nothing_beside_it():
    """It ran where every extra and both referees were installed, so what fails on a new machine stayed green."""
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    end = script[script.index('clone "$apart/clone"\n') :]
    assert "line=$(grep -m1 'python -m pytest' README.md)" in end
    assert "pip install" not in end
    assert 'HOME="$apart/home" PATH="$apart/programs"' in end
    assert end.rstrip().endswith('bash -c "$line"')
    for _, commands, _ in needs.PROGRAMS.values():
        for name in commands:
            assert re.search(rf"[{{,]{re.escape(name.removesuffix('-browser'))}\*?[,}}]", end), name


def test_every_extra_that_a_test_needs_is_in_the_ci():
    script = (ROOT / ".ci" / "run").read_text(encoding="utf-8")
    installed = set(re.search(r"--editable '\.\[([a-z,]+)\]'", script)[1].split(","))
    system = (ROOT / ".ci" / "system-libraries").read_text(encoding="utf-8")
    texts = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "tests").rglob("test_*.py"))
    wanted = {name for call in re.findall(r"mark\.needs\(([^)*]+)\)", texts) for name in re.findall(r'"(\w+)"', call)}
    assert {"docs", "fast", "robotics", "calculix"} <= wanted - {"dosc"}
    programs = wanted & set(needs.PROGRAMS)
    assert wanted - programs <= installed
    assert "compiler" in programs  # its tests were skipped, as the CI installed none
    for name in programs:
        assert re.search(rf"[ \"]{re.escape(needs.PROGRAMS[name][2])}[ \"]", system), name


def test_every_command_stands_under_its_question():
    page = (ROOT / "docs" / "start" / "which_command.md").read_text(encoding="utf-8")
    told = [row.split("|")[2].strip() for row in page.splitlines() if row.startswith("| ")]
    names = [match[1] for cell in told if (match := re.match(r"`cyclo ([\w-]+)", cell))]
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert set(names) == set(project["entry-points"]["cyclo.commands"])
    assert len(set(told)) == len(told)
    assert all(re.fullmatch(r"command|---|`cyclo [^`]+`", cell) for cell in told)
    for start in ("README.md", "docs/index.md", "docs/start/index.md"):
        assert "which_command.md" in (ROOT / start).read_text(encoding="utf-8"), start


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_examples_pin_a_number_that_readers_do_not_see(path):
    """They are run by the documentation, once; here only that each can fail."""
    text = path.read_text(encoding="utf-8")
    assert text.count(START) == text.count(END) == 1
    hidden = text[text.index(START) : text.index(END)]
    assert any(isinstance(node, ast.Assert) for node in ast.walk(ast.parse(hidden)))
    title, line = ast.get_docstring(ast.parse(text)).splitlines()[:2]
    assert set(line) == {"="}
    assert len(line) >= len(title)


@pytest.mark.needs("docs")
@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_the_notebook_of_an_example_has_its_code(path, monkeypatch, tmp_path):
    """Made as the pages make it; the check that readers do not see is not in it."""
    from sphinx_gallery import gen_gallery, notebook, py_source_parser

    settings = gen_gallery.DEFAULT_GALLERY_CONF | {"examples_dirs": [str(path.parent)], "src_dir": str(tmp_path)}
    _, blocks = py_source_parser.split_code_and_text_blocks(str(path))
    made = notebook.jupyter_notebook(
        [(kind, py_source_parser.remove_ignore_blocks(text), line) for kind, text, line in blocks],
        settings, str(tmp_path),
    )  # fmt: skip
    cells = ["".join(cell["source"]) for cell in made["cells"] if cell["cell_type"] == "code"]
    text = path.read_text(encoding="utf-8")
    shown = ast.parse(text[: text.index(START)])
    code = ast.parse("\n".join(line for line in "\n".join(cells).splitlines() if not line.startswith("%")))
    assert ast.unparse(code) == ast.unparse(ast.Module(body=shown.body[1:], type_ignores=[]))
