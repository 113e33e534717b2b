"""A page from templates, style and scripts: one file that opens offline, the same from the same content."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from importlib import resources
from pathlib import Path
from typing import Any

from ltca.output.files import whole_file

SCRIPTS = ("svg", "tables")
"""Scripts of every page, in the order they are joined."""


def page_text(
    template: str, context: Mapping[str, Any], *, scripts: Sequence[str] = (), package: str | None = None
) -> str:
    """Return a page.

    Parameters
    ----------
    template : str
        Its template, which extends ``base.html``.
    context : mapping
        What it shows; names from drive files are texts, whatever they contain.
    scripts : sequence of str
        Of `ltca.page.scripts`, after `SCRIPTS`.
    package : str, optional
        Package with further templates, in its folder ``templates``.
    """
    import jinja2

    loaders = [jinja2.PackageLoader("ltca.page"), *([jinja2.PackageLoader(package)] if package else [])]
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(loaders), autoescape=True, trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    environment.filters["signs"] = _with_signs
    folder = resources.files("ltca.page") / "scripts"
    joined = "\n".join((folder / f"{name}.js").read_text(encoding="utf-8") for name in (*SCRIPTS, *scripts))
    style = (resources.files("ltca.page") / "templates" / "page.css").read_text(encoding="utf-8")
    return environment.get_template(template).render({"style": style, "scripts": joined, **context}) + "\n"


def _with_signs(text: str) -> Any:
    """The text with indices below the line."""
    from markupsafe import Markup, escape

    return Markup(str(escape(text)).replace("φ_C", "φ<sub>C</sub>"))


def write_page(path: Path, text: str) -> Path:
    """Write a page; return where it is.

    Raises
    ------
    CycloError
        When it cannot be written.
    """
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8")
    return path


def script_data(content: Any) -> str:
    """Return content as JSON for a script element, which no name in it can end.

    Examples
    --------
    >>> script_data({"case": "</script>"})
    '{"case":"\\\\u003c/script>"}'
    """
    # "</" would end the script element early, "<!--<script" keep it from ending.
    text = json.dumps(content, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
