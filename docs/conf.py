"""Sphinx configuration: ``python -m sphinx -W --keep-going -b html docs build/docs`` builds the pages offline."""

from __future__ import annotations

import importlib.util
import os
import sys
import warnings
from importlib.metadata import metadata, version as installed
from pathlib import Path
from typing import Any

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"):
    os.environ.setdefault(variable, "1")
os.environ.setdefault("MPLBACKEND", "Agg")
HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent)]

from sphinx.errors import ConfigError

for package in ("pydata_sphinx_theme", "sphinx_gallery", "myst_parser", "numpydoc"):
    if importlib.util.find_spec(package) is None:
        raise ConfigError(f"the Python package {package} is not installed: pip install --editable '.[docs]'")

import generated_pages  # beside this file
from sphinx_gallery import gen_gallery

project = "cyclo"
author = "The cyclo developers"
copyright = "the cyclo developers"
release = installed("cyclo-ltca")
version = release

extensions = ["sphinx.ext.autodoc", "numpydoc", "myst_parser", "sphinx_gallery.gen_gallery"]
source_suffix = {".rst": "restructuredtext", ".md": "markdown"}
root_doc = "index"
exclude_patterns = ["build", "gallery/**/*.ipynb", "gallery/**/*.py", "gallery/**/*.json"]
suppress_warnings = ["config.cache"]
nitpicky = True
# No inventories are downloaded: names of other libraries remain plain text.
nitpick_ignore_regex: list[tuple[str, str]] = []
default_role = "code"

myst_enable_extensions = ["colon_fence", "deflist"]
myst_heading_anchors = 3

autodoc_member_order = "bysource"
autodoc_typehints = "none"
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

sphinx_gallery_conf = {
    "examples_dirs": "../examples",
    "gallery_dirs": "gallery",
    "filename_pattern": r"/\w+\.py$",
    "within_subsection_order": "FileNameSortKey",
    "remove_config_comments": True,
    "show_memory": False,
    "show_signature": False,
    "download_all_examples": True,
    "min_reported_time": 1e9,
    "abort_on_example_error": False,
    "copyfile_regex": r".*\.toml",
    "matplotlib_animations": False,
    "write_computation_times": False,
}
# Subfolders of examples/ hold input files of commands, not scripts of the gallery.
gen_gallery.get_subsections = lambda *_, **__: []
# A warning of the library in an example is treated as an error.
warnings.filterwarnings("error", category=RuntimeWarning)

html_theme = "pydata_sphinx_theme"
html_title = "cyclo"
html_static_path = ["style"]
html_css_files = ["cyclo.css"]
html_copy_source = False
smartquotes = False
html_show_sphinx = False
html_last_updated_fmt = None
html_theme_options: dict[str, Any] = {
    "logo": {"text": "cyclo"},
    "navbar_align": "left",
    "header_links_before_dropdown": 6,
    "show_toc_level": 2,
    "navigation_depth": 2,
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
# Public addresses stand in pyproject.toml; there are none before the repository is public.
addresses = dict(line.split(", ", 1) for line in metadata("cyclo-ltca").get_all("Project-URL") or ())
html_theme_options["external_links"] = [
    {"name": name, "url": addresses[name]} for name in ("Repository", "Issues") if name in addresses
]
html_sidebars: dict[str, list[str]] = {"index": [], "start/index": []}


def add_single_pages(app: Any, docname: str, source: list[str]) -> None:
    """Lead links to pages of the build, and append the pages of single features (``docs/*.md``) to the how-to list."""
    source[0] = generated_pages.built_links(docname, source[0])
    if docname != "how-to/index":
        return
    pages = sorted(path for path in HERE.glob("*.md") if path.stem != root_doc)
    if pages:
        titles = [path.read_text(encoding="utf-8").lstrip().partition("\n")[0].lstrip("# ") for path in pages]
        listed = "\n".join(f"- [{title}](../{path.name})" for path, title in zip(pages, titles, strict=True))
        tree = "\n".join(f"/{path.stem}" for path in pages)
        source[0] += f"\n**More**\n\n{listed}\n\n```{{toctree}}\n:hidden:\n\n{tree}\n```\n"


def setup(app: Any) -> None:
    """Write the generated pages before the sources are read."""
    app.connect("builder-inited", lambda _: generated_pages.write_pages(HERE / "reference" / "generated"))
    app.connect("source-read", add_single_pages)
    app.connect("env-get-outdated", lambda *_: ["how-to/index"])
