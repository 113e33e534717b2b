"""A drive as the text of a drive file."""

from __future__ import annotations

from dataclasses import fields, is_dataclass
from typing import Any

from ltca.drive.materials import PARTS, Material
from ltca.drive.parts import Analysis, Drive
from ltca.drive.unit_mistakes import materials_of_bodies


def drive_text(drive: Drive) -> str:
    """Return a drive as the text of a drive file that reads back as the same drive, bit for bit.

    An engine is written where it is not the default: what a file says of it counts as its author's own wish.

    Examples
    --------
    >>> from ltca.reading.drive_file import load_drive, parse_drive
    >>> drive = load_drive("paper").cases["CS-3"]
    >>> parse_drive(drive_text(drive)).cases["nominal"] == drive
    True
    """
    lines: list[str] = []
    _write_table(drive, "", lines, _without_effect(drive))
    return "\n".join(lines).strip() + "\n"


def _without_effect(drive: Drive) -> set[str]:
    """Paths of default values of what the drive has not: materials of parts, the gap beside planes of the discs."""
    there = {path.removeprefix("materials.") for path in materials_of_bodies(drive)}
    found = {
        f"materials.{part}" for part in PARTS if part not in there and getattr(drive.materials, part) == Material()
    }
    return found | ({"disc.gap"} if drive.disc.planes and drive.disc.gap == 0.0 else set())


def _write_table(part: Any, path: str, lines: list[str], left_out: set[str]) -> None:
    inner = []
    if part == Analysis() or path in left_out:
        return
    if path:
        lines.append(f"\n[{path}]")
    for item in fields(part):
        value = getattr(part, item.name)
        if not item.compare or f"{path}.{item.name}" in left_out:  # the name of the case is no field
            continue
        if is_dataclass(value):
            inner.append((f"{path}.{item.name}" if path else item.name, value))
        elif value is not None and value != ():
            lines.append(f"{item.name} = {_literal(value)}")
    for name, value in inner:
        _write_table(value, name, lines, left_out)


def _literal(value: Any) -> str:
    if is_dataclass(value):  # an entry of `of` or `duty`
        own = ((item.name, getattr(value, item.name)) for item in fields(value))
        inner = ", ".join(f"{name} = {_literal(held)}" for name, held in own if held is not None and held != ())
        return f"{{ {inner} }}" if inner else "{}"
    if isinstance(value, tuple):
        return "[" + ", ".join(_literal(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        escaped = value.replace("\\", "\\\\").replace('"', '\\"')
        return f'"{escaped}"'
    return repr(value)
