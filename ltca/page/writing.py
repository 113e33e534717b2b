"""A page from templates, style and scripts: one file that opens offline, the same from the same content."""

from __future__ import annotations

import json
import re
from base64 import b64encode
from collections.abc import Mapping, Sequence
from functools import cache
from hashlib import sha256
from importlib import resources
from pathlib import Path
from typing import Any

from ltca.output.files import whole_file

SCRIPTS = ("svg", "tables")
"""Scripts of every page, in the order they are joined."""
UNBROKEN = re.compile(r"φ_C = |\d %")
"""Where no line may end."""
BREAK = re.compile(r"(?<=[a-z0-9])[._](?=[a-z0-9])")
"""Where the name of a field may go on in the next line."""


def page_text(
    template: str,
    context: Mapping[str, Any],
    *,
    scripts: Sequence[str] = (),
    styles: Sequence[str] = (),
    package: str | None = None,
    live: bool = False,
) -> str:
    """Return a page from a template that extends ``base.html``; names from drive files in its context are texts.

    `scripts`, of `ltca.page.scripts` or of the package, follow `SCRIPTS`, and `styles` of the package follow ``page.css``;
    `package` has further templates in its folder ``templates`` and scripts in ``scripts``. A `live` page may ask the server it
    came from.

    Notes
    -----
    The page's own script and style are all that a browser runs and applies, by their hashes: what comes into a page otherwise,
    whatever fault let it in, is not executed, and nothing is loaded.
    """
    own = resources.files("ltca.page")
    folders = [own / "scripts", own / "templates"]
    if package:
        folders += [resources.files(package) / name for name in ("templates", "scripts")]

    def joined(*names: str) -> str:
        found = [next(file for folder in folders if (file := folder / name).is_file()) for name in names]
        return "\n".join(file.read_text(encoding="utf-8") for file in found)

    script = joined(*(f"{name}.js" for name in (*SCRIPTS, *scripts)))
    style = joined(*(f"{name}.css" for name in ("page", *styles)))
    page = {"style": style, "scripts": script, "policy": _policy(script, style, live), **context}
    return fragment(template, page, package) + "\n"


def fragment(template: str, context: Mapping[str, Any], package: str | None = None) -> str:
    """Return a template filled in, of `ltca.page` or of the package; names from drive files in its context are texts."""
    return str(_environment(package).get_template(template).render(context))


@cache
def _environment(package: str | None) -> Any:
    import jinja2

    loaders = [jinja2.PackageLoader("ltca.page"), *([jinja2.PackageLoader(package)] if package else [])]
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader(loaders), autoescape=True, trim_blocks=True, lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )  # fmt: skip
    environment.filters["signs"] = _with_signs
    environment.filters["breaks"] = _with_breaks
    return environment


def _policy(script: str, style: str, live: bool) -> str:
    """The content security policy of a page: its one script, its one style, pictures within it, and its server if it has one."""

    def source(text: str) -> str:
        return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode('ascii')}'"

    return (
        f"default-src 'none'; script-src {source(script)}; style-src {source(style)}; img-src data: blob:; "
        f"{'connect-src ' + repr('self') + '; ' if live else ''}base-uri 'none'; form-action 'none'"
    )


def _with_signs(text: str) -> Any:
    """The text with indices below the line; lines are not broken before a per cent sign or about that of a crank angle."""
    from markupsafe import Markup, escape

    whole = UNBROKEN.sub(lambda found: found[0].replace(" ", "\N{NO-BREAK SPACE}"), str(escape(text)))
    return Markup(whole.replace("φ_C", "φ<sub>C</sub>"))


def _with_breaks(text: str) -> Any:
    """The text, of which names of fields may be broken behind dots and underscores."""
    from markupsafe import Markup, escape

    return Markup(BREAK.sub(r"\g<0><wbr>", str(escape(text))))


def write_page(path: Path, text: str) -> Path:
    """Write a page; return where it is."""
    with whole_file(path) as part:
        part.write_text(text, encoding="utf-8", newline="\n")
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
