"""``cyclo studio``: what it refuses before it serves."""

from __future__ import annotations

import socket
import sys

import pytest

from ltca.commands.program import main


def told(capsys):
    return capsys.readouterr().err


def test_a_missing_package_is_one_line_that_says_what_to_install(monkeypatch, capsys):
    for name in [name for name in sys.modules if name.startswith("ltca.studio.server")]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "starlette.applications", None)
    monkeypatch.setitem(sys.modules, "starlette", None)
    assert main(["studio", "paper", "--no-browser"]) == 2
    assert told(capsys) == (
        "cyclo: error: cyclo studio needs starlette and uvicorn, which are not installed: pip install 'cyclo-ltca[studio]'\n"
    )


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["no.toml"], "no such file"),
        (["paper", "--case", "CS-9"], "case 'CS-9' is not defined"),
        (["paper", "--port", "70000"], "--port = 70000: must be from 0 to 65535"),
    ],
)
def test_wrong_arguments_are_told_by_name(words, expected, capsys):
    try:
        status = main(["studio", *words])
    except SystemExit as end:
        status = end.code
    assert status == 2
    assert expected in told(capsys)


def test_a_drive_elsewhere_is_refused(tmp_path, monkeypatch, capsys):
    from ltca.reading.drive_file import shipped_drive

    (tmp_path / "mine.toml").write_text(shipped_drive("paper"), encoding="utf-8")
    (tmp_path / "below").mkdir()
    monkeypatch.chdir(tmp_path / "below")
    assert main(["studio", "../mine.toml"]) == 2
    assert "must lie in the folder in which the studio is started" in told(capsys)


@pytest.mark.needs("studio")
def test_a_port_that_is_taken_is_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["studio", "paper", "--no-browser", "--port", str(port)]) == 1
    assert f"--port {port}: cannot be had" in told(capsys)
