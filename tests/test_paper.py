"""The paper for the Journal of Open Source Software: its form, its references, and the source of each of its figures.

Form and length are those of the author guide (docs/paper.md of openjournals/joss, read in November 2026).
"""

from __future__ import annotations

import re
from pathlib import Path

import pypandoc
import yaml

ROOT = Path(__file__).parents[1]
PAPER = ROOT / "paper" / "paper.md"
_, HEAD, BODY = PAPER.read_text(encoding="utf-8").split("---\n", 2)
META = yaml.safe_load(HEAD)
BIBLIOGRAPHY = (PAPER.parent / META["bibliography"]).read_text(encoding="utf-8")
SECTIONS = [
    "Summary", "Statement of need", "State of the field", "Software design", "Research impact statement",
    "AI usage disclosure", "Acknowledgements", "References",
]  # fmt: skip
LEAST_WORDS, MOST_WORDS = 750, 1750

MODELS, TABLE = "docs/validation/index.md", "docs/validation/paper.md"
SOURCES = {
    "0.07 %": (MODELS, "| `fe` | 0.07 % | 0.43 % | 0.07″ |"),
    "0.07″": (MODELS, "| `fe` | 0.07 % | 0.43 % | 0.07″ |"),
    "51 %": (MODELS, "| half-space | −51 % (a shaft pin)"),
    "58.5″": (MODELS, "+58.5″ of −470″"),
    "0.039 %": (MODELS, "loads agree within 0.039 % of the largest of their kind"),
    "44 s": (MODELS, "takes 2,147 s of processor time and `cyclo` 44 s"),
    "2,147 s": (MODELS, "takes 2,147 s of processor time and `cyclo` 44 s"),
    "8482 N": (TABLE, "| mean bearing load, CS-1 | 8482 N | 8460 N |"),
    "8460 N": (TABLE, "| mean bearing load, CS-1 | 8482 N | 8460 N |"),
    "5.4″": (TABLE, "| 5.4″ / 6.2″ / 9.9″ | 3.2″ / 3.7″"),
    "3.2″": (TABLE, "| 5.4″ / 6.2″ / 9.9″ | 3.2″ / 3.7″"),
    "0.55": ("docs/theory/accuracy.md", "changes the largest torque share of a disc from 0.50 to 0.55"),
    "3.0 µm": ("docs/theory/accuracy.md", "a runout of 3.0 µm of one disc"),
    "400 N·m": ("README.md", "A robot joint at 400 N·m reaches it with 3.0 µm of runout"),
}
"""Where each figure of the paper is printed with the command that computes it."""


def prose(body):
    """The text without its table, code and headings."""
    lines = [line for line in body.splitlines() if not line.startswith(("|", "#", ": "))]
    return re.sub(r"`[^`]*`", "", "\n".join(lines))


def figures(body):
    """Every number in digits, with its unit."""
    return re.findall(
        r"(?<![\w.])\d[\d.,]*\d(?:\s?(?:%|″|′|N·m|N|MPa|µm|mm|s)(?!\w))?|(?<![\w.])\d\s?(?:%|″|′|N·m|N|µm|mm|s)(?!\w)",
        prose(body),
    )


def keys(body):
    return set(re.findall(r"@([a-z]+)", body))


def test_head_has_what_the_journal_needs():
    assert {"title", "tags", "authors", "affiliations", "date", "bibliography"} <= set(META)
    assert re.fullmatch(r"\d{1,2} [A-Z][a-z]+ 20\d\d", META["date"])
    indices = {str(one["index"]) for one in META["affiliations"]}
    for author in META["authors"]:
        assert author["name"]
        assert set(str(author["affiliation"]).split(", ")) <= indices


def test_title_is_that_of_the_citation():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert META["title"] == citation["title"]
    assert [one["name"] for one in META["authors"]] == [one["name"] for one in citation["authors"]]


def test_sections_in_order():
    assert re.findall(r"^# (.+)$", BODY, re.MULTILINE) == SECTIONS


def test_length():
    words = len(re.findall(r"\w[\w'’-]*", BODY))
    assert LEAST_WORDS <= words <= MOST_WORDS


def test_every_citation_has_its_entry_and_every_entry_is_cited():
    entries = re.findall(r"^@\w+\{(\w+),", BIBLIOGRAPHY, re.MULTILINE)
    assert len(set(entries)) == len(entries)
    assert keys(BODY) == set(entries)


def test_entries_can_be_found():
    """Articles, books and data have a DOI, programs an address; the paper that the package follows has its title alone."""
    for entry in re.split(r"^@", BIBLIOGRAPHY, flags=re.MULTILINE)[1:]:
        key = entry.partition("{")[2].partition(",")[0]
        assert re.search(r"^\s+title\s+= \{", entry, re.MULTILINE), key
        if entry.startswith(("article", "book")):
            assert re.search(r"doi\s+= \{10\.\d{4,}/\S+\}", entry), key
        elif key != "clearances":
            assert re.search(r"doi\s+= \{10\.\d{4,}/\S+\}|url\s+= \{https://\S+\}", entry), key


def test_every_figure_has_its_source():
    assert sorted(set(figures(BODY))) == sorted(SOURCES)
    for figure, (page, text) in SOURCES.items():
        assert text in (ROOT / page).read_text(encoding="utf-8"), figure


def test_the_count_of_cases_is_that_of_the_manual():
    """It says "more than forty", as the page of validation does."""
    assert "more than forty cases" in " ".join(BODY.split())
    counted = re.search(
        r"\*\*(\d+) of \1 cases pass\*\*", (ROOT / "docs/validation/manual/index.md").read_text(encoding="utf-8")
    )
    assert int(counted[1]) > 40


def test_the_checks_themselves_can_fail():
    assert figures("0.07 % of 8 s, `3 mm` and 12 cases of @numpy.\n| 5 % |\n") == ["0.07 %", "8 s", "12"]
    assert keys("as @numpy and [@scipy; @gmsh] say") == {"numpy", "scipy", "gmsh"}


def test_pandoc_builds_it(tmp_path):
    """With its references, and without a warning (one of pandoc is of a citation that it does not find)."""
    text = pypandoc.convert_file(
        str(PAPER), "plain",
        extra_args=["--citeproc", "--fail-if-warnings", "--wrap=none", f"--bibliography={PAPER.parent / 'paper.bib'}"],
    )  # fmt: skip
    references = text.rpartition("References")[2]
    for name in ("Gustafsson", "Geuzaine", "Virtanen", "10.5281/zenodo.2166718"):
        assert name in references
    assert "???" not in text
    assert "(**" not in text
