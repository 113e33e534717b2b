"""The studio without a browser: who may ask it, what it reads and writes, how questions are dropped and mistakes told."""

from __future__ import annotations

import concurrent.futures
import os
import signal
import time
import tomllib
from pathlib import Path

import pytest

from ltca.reading.drive_file import shipped_drive

pytestmark = [pytest.mark.slow, pytest.mark.needs("studio")]
PAPER = shipped_drive("paper")
HEAVY = shipped_drive("rv")
"""A drive whose fine answer takes a second or more."""


def question(text=PAPER, quality="coarse", tab="one", **more):
    return {"text": text, "tab": tab, "case": "CS-1", "quality": quality, **more}


def test_only_this_host_with_the_token_is_answered(running):
    ask, own = running.ask, f"127.0.0.1:{running.address.split(':')[2].split('/')[0]}"
    assert ask().status == 200
    assert ask(headers={"Host": own.replace("127.0.0.1", "localhost")}).status == 200
    for host in ("evil.example", "evil.example:80", "127.0.0.1", own + "0", ""):
        assert ask(headers={"Host": host}).status == 421, host
    for root in ("/", "/wrong/", "//", f"/{running.address.split('/')[3][:-1]}/", "/%00/"):
        assert ask(root=root).status == 403, root
    assert ask("edit", {"text": PAPER}, headers={"Origin": "http://evil.example"}).status == 403
    assert ask("edit", {"text": PAPER}, headers={"Origin": f"http://{own}"}).status == 200
    assert ask("edit", b"text=1", headers={"Content-Type": "text/plain"}).status == 415
    assert ask("edit", b"{}", headers={"Content-Length": "99999999"}).status == 413


def test_a_page_runs_its_own_script_alone_and_nothing_else_is_shown_anywhere(running):
    page = running.ask()
    policy = page.body.decode().split('Content-Security-Policy" content="')[1].split('"')[0]
    assert policy.startswith("default-src 'none'; script-src 'sha256-")
    assert "unsafe" not in policy
    assert "connect-src 'self'" in policy
    for answer in (page, running.ask("jobs"), running.ask("files/x"), running.ask(root="/")):
        assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["cache-control"] == "no-store"
        assert answer.headers["referrer-policy"] == "no-referrer"


@pytest.mark.parametrize(
    "path",
    ["files/../../etc/passwd", "files/%2e%2e/%2e%2e/etc/passwd", "files//etc/passwd", "files/paper.toml", "files/%00",
     "files/..%2f..%2fetc%2fpasswd", "files/out/paper_studio/1/../../../secret.toml"],
)  # fmt: skip
def test_no_file_but_those_of_jobs_is_handed_out(running, path):
    (running.folder / "secret.toml").write_text("name = 'secret'\n")
    assert running.ask(path).status == 404


@pytest.mark.parametrize("name", ["../outside", "a/b", ".hidden", "", "..", "a\x00b", "/tmp/x"])
def test_files_are_saved_in_the_folder_alone(running, name):
    before = sorted(running.folder.iterdir())
    found = running.ask("save", {"text": PAPER, "name": name}).body
    assert "can name a file" in found["problems"][0]["text"]
    assert sorted(running.folder.iterdir()) == before


@pytest.mark.parametrize("name", ["con:|", "a?b", "a*", 'a"b', "<a>", "a$b"])
def test_names_that_are_not_portable_are_refused(running, name):
    before = sorted(running.folder.iterdir())
    found = running.ask("save", {"text": PAPER, "name": name}).body
    assert "only letters, digits, spaces and . _ -" in found["problems"][0]["text"]
    assert sorted(running.folder.iterdir()) == before


@pytest.mark.parametrize(
    ("name", "told"),
    [
        *(
            (name, "device of Windows")
            for name in ("CON", "nul", "Aux.drive", "com1", "LPT9", "com²", "prn .x", "nul.toml")
        ),
        *((name, "nor end with a dot") for name in ("mine.", "mine ", " mine", "mine..toml")),
    ],
)
def test_names_that_windows_reads_in_another_way_are_refused(running, name, told):
    before = sorted(running.folder.iterdir())
    assert told in running.ask("save", {"text": PAPER, "name": name}).body["problems"][0]["text"]
    assert sorted(running.folder.iterdir()) == before


def test_letters_of_any_script_name_a_saved_file(running):
    assert running.ask("save", {"text": PAPER, "name": "Getriebe ü_2.1-б"}).body == {"saved": "Getriebe ü_2.1-б.toml"}
    assert running.ask("save", {"text": PAPER, "name": "con-rod"}).body == {"saved": "con-rod.toml"}


def test_a_saved_file_is_replaced_on_demand_and_never_through_a_link(running, tmp_path):
    save = lambda **more: running.ask("save", {"text": PAPER, "name": "mine", **more}).body  # noqa: E731
    assert save() == {"saved": "mine.toml"}
    assert save() == {"exists": "mine.toml"}
    assert save(text=PAPER + "# more\n", overwrite=True) == {"saved": "mine.toml"}
    assert (running.folder / "mine.toml").read_text(encoding="utf-8") == PAPER + "# more\n"
    target = tmp_path / "target.toml"
    target.write_text("kept")
    (running.folder / "link.toml").symlink_to(target)
    assert "is no file of its own" in str(save(name="link", overwrite=True)["problems"])
    assert target.read_text() == "kept"


@pytest.mark.parametrize("name", ["/etc/passwd", "../../../../etc/passwd", "nul\x00"])
def test_no_measured_file_elsewhere_is_read(running, name):
    import json

    text = PAPER.replace("profile_errors = { orders = [2, 3, 13, 26] }", f"measured_flank = {json.dumps(name)}")
    for found in (
        running.ask("answer", question(text)).body,
        running.ask("jobs", {"text": text, "case": "CS-1", "job": {"kind": "fem"}}).body,
    ):
        (problem,) = found["problems"]
        assert "must be a file in the folder of the studio" in problem["text"]
        assert "root" not in problem["text"]


def test_mistakes_are_told_by_field(running):
    edit = {"text": PAPER, "case": "CS-1", "changes": {"pin_wheel.pin_radius": "-3", "load.torque": "4 apples"}}
    changed = running.ask("edit", edit).body
    assert tomllib.loads(changed["text"])["load"]["torque"] == "4 apples"
    told = running.ask("answer", question(changed["text"])).body["problems"]
    assert {path for one in told for path in one["fields"]} == {"pin_wheel.pin_radius", "load.torque"}
    for changes, expected in (
        ({"no.field": "1"}, "is no field"),
        ({"disc.__class__": "1"}, "is no field"),
        ({"disc.of.7.runout.amount": "1"}, "cannot be changed"),
        ([], "must be texts by field"),
        ({"disc.thickness": 3}, "must be texts by field"),
    ):
        found = running.ask("edit", {"text": PAPER, "case": "", "changes": changes}).body
        assert expected in found["problems"][0]["text"], changes


@pytest.mark.parametrize(
    "content",
    [b"[]", b"{", b"\xff", {"text": 3}, question(quality="finest"), question(compliance="rubber"),
     question(case="x" * 400), question(text="a = " + "[" * 9000), question(text="")],
)  # fmt: skip
def test_no_question_is_unforeseen(running, content):
    found = running.ask("answer", content)
    assert found.status == 200
    assert found.body["problems"]
    assert "unforeseen" not in str(found.body)


def stat_of(number):
    """Parent and processor time, in ticks, of a process; of one that has gone, that of nobody."""
    try:
        fields = Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0, 0
    return int(fields[1]), int(fields[11]) + int(fields[12])


def workers_of(running):
    """Processes of the studio that answer: children of its child, which forks them."""
    numbers = [int(entry) for entry in os.listdir("/proc") if entry.isdigit()]
    parents = {number: stat_of(number)[0] for number in numbers}
    return {number for number, parent in parents.items() if parents.get(parent) == running.process.pid}


def wait_until(there):
    """Wait for a condition, however busy the machine is, and return what it gives."""
    end = time.monotonic() + 300.0
    while not (found := there()) and time.monotonic() < end:
        time.sleep(0.02)
    assert found
    return found


@pytest.fixture
def computing(running):
    """Ask for a fine answer of the heavy drive in a tab; give the answer to come, and the process that computes it."""
    with concurrent.futures.ThreadPoolExecutor() as pool:

        def ask(tab):
            running.ask("answer", question(HEAVY, tab=tab))  # what answers coarse questions is there
            before = workers_of(running)
            asked = pool.submit(running.ask, "answer", question(HEAVY, "fine", tab=tab))
            return asked, wait_until(
                lambda: next((one for one in workers_of(running) - before if stat_of(one)[1] >= 5), None)
            )

        yield ask


def test_an_answer_that_is_no_longer_wanted_is_dropped_at_once(running, computing):
    old, worker = computing("two")
    os.kill(worker, signal.SIGSTOP)  # it would never be there
    new = running.ask("answer", question(PAPER, tab="two")).body
    assert old.result().body == {"superseded": True}
    assert new["positions"] == 36


def test_tabs_do_not_know_of_each_other(running):
    with concurrent.futures.ThreadPoolExecutor() as pool:
        asked = [
            pool.submit(running.ask, "answer", question(text, tab=tab)) for tab, text in (("a", PAPER), ("b", HEAVY))
        ]
        assert [one.result().body["drive"] for one in asked] == ["paper", "rv"]
    assert running.ask("leave", {"tab": "a"}).status == 200
    assert running.ask("answer", question(PAPER, tab="b")).body["drive"] == "paper"


def test_a_drive_without_an_answer_says_why(running):
    found = running.ask("answer", question(PAPER.replace("torque = 377300.0", "torque = 0.0"))).body
    (problem,) = found["problems"]
    assert "nothing says where discs and wheel stand" in problem["text"]
    assert problem["fields"] == ["load.torque"]


def test_a_killed_worker_is_told_and_replaced(running, computing):
    asked, worker = computing("killed")
    os.kill(worker, signal.SIGSTOP)  # its answer would not come before
    os.kill(worker, signal.SIGKILL)
    assert "has ended" in asked.result().body["failure"]
    assert running.ask("answer", question(PAPER, tab="killed")).body["drive"] == "paper"
