"""The studio without a browser: who may ask it, what it reads and writes, how questions are dropped and mistakes told."""

from __future__ import annotations

import concurrent.futures
import json
import os
import random
import re
import signal
import socket
import time
import tomllib
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from ltca.reading.drive_file import shipped_drive

from .conftest import asker, exchanged, studio

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


@pytest.mark.parametrize("name", ["-rf", "--debug", "-"])
def test_names_that_are_options_of_commands_are_refused(running, name):
    before = sorted(running.folder.iterdir())
    assert "must not begin with -" in running.ask("save", {"text": PAPER, "name": name}).body["problems"][0]["text"]
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


@pytest.mark.parametrize("path", ["edit", "answer", "save", "jobs", "leave"])
def test_half_a_surrogate_pair_is_refused(running, path):
    """It was answered with status 500: no answer could be encoded."""
    found = running.ask(
        path, b'{"text": "a = 1 # \\\\ud800", "tab": "one", "case": "\\\\udfff"}'.replace(b"\\\\", b"\\")
    )
    assert found.status == 400
    assert b"half of a surrogate pair" in found.body
    assert running.ask(path, b'{"text": "# \\ud83d\\ude00"}').status == 200  # a whole pair is a character


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


@contextmanager
def computing_in(server):
    """Give a function that asks a studio for a fine answer in a tab, and returns the answer to come and its process."""
    ask = asker(server.address)
    with concurrent.futures.ThreadPoolExecutor() as pool:

        def begin(tab):
            ask("answer", question(HEAVY, tab=tab))  # what answers coarse questions is there
            before = workers_of(server)
            asked = pool.submit(ask, "answer", question(HEAVY, "fine", tab=tab))
            return asked, wait_until(
                lambda: next((one for one in workers_of(server) - before if stat_of(one)[1] >= 5), None)
            )

        yield begin


@pytest.fixture
def computing(running):
    """Ask for a fine answer of the heavy drive in a tab; give the answer to come, and the process that computes it."""
    with computing_in(running) as begin:
        yield begin


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


def children(number):
    """Processes that a process has started, with what their command lines say."""
    found = {}
    for entry in os.listdir("/proc"):
        if entry.isdigit():
            with suppress(OSError):  # it has gone
                fields = Path(f"/proc/{entry}/stat").read_text().rpartition(")")[2].split()
                if int(fields[1]) == number:
                    found[int(entry)] = Path(f"/proc/{entry}/cmdline").read_text().replace("\0", " ")
    return found


def kill_fork_server(process):
    (server,) = (number for number, words in children(process.pid).items() if "forkserver" in words)
    workers = list(children(server))
    os.kill(server, signal.SIGKILL)
    return workers


def gone(number):
    try:
        return Path(f"/proc/{number}/stat").read_text().rpartition(")")[2].split()[0] == "Z"
    except OSError:
        return True


def test_a_killed_fork_server_is_replaced(running):
    """Its workers removed the folder of sockets, in which no other server could be started: no answer until the next start."""
    running.ask("answer", question(tab="server"))
    with concurrent.futures.ThreadPoolExecutor() as pool:
        for _ in range(2):
            before = workers_of(running)
            fine = pool.submit(running.ask, "answer", question(HEAVY, "fine", tab="server"))
            wait_until(
                lambda before=before: workers_of(running) - before or any(stat_of(one)[1] >= 5 for one in before)
            )
            workers = kill_fork_server(running.process)
            assert workers
            for tab in ("server", "other"):
                assert running.ask("answer", question(tab=tab)).body["drive"] == "paper"
            fine.result()
        # What the dead server started ends with its last question, and not with the studio.
        for tab in ("server", "other"):
            running.ask("leave", {"tab": tab})
        wait_until(lambda: all(map(gone, workers)))
    assert running.ask("answer", question(tab="server")).body["drive"] == "paper"


def test_120_half_open_connections_do_not_stop_it(tmp_path):
    """With 100 open files: nobody was answered, and tracebacks of 50 MB were written.

    The time until a header is there is not what helps: it is an hour here.
    """
    program = (
        "import sys; from ltca.studio import connections; connections.HEADER_SECONDS = 3600.0; "
        "from ltca.commands.program import main; sys.exit(main(sys.argv[1:]))"
    )
    few_files = ("bash", "-c", f'ulimit -n 100; exec "$1" -c \'{program}\' "${{@:4}}"', "bash")
    with studio("paper", tmp_path, before=few_files) as found, ExitStack() as stack:
        ask, parts = asker(found.address), urlsplit(found.address)
        for number in range(120):
            one = stack.enter_context(socket.create_connection((parts.hostname, parts.port), timeout=300))
            with suppress(ConnectionError):
                one.sendall(b"" if number % 2 else b"GET / HTTP/1.1\r\nHost: ")
        assert ask().status == 200
        assert ask("answer", question()).body["drive"] == "paper"
        assert found.errors() == ""


def test_the_command_line_of_the_browser_has_no_token(tmp_path):
    """Any user of the machine can read it."""
    browser, seen = tmp_path / "browser", tmp_path / "seen"
    browser.write_text(
        f'#!/bin/sh\necho "$@" > {seen}.part\ncat "${{1#file://}}" >> {seen}.part\nmv {seen}.part {seen}\n'
    )
    browser.chmod(0o700)
    with studio("paper", tmp_path, browser=f"{browser} %s") as found:
        wait_until(seen.exists)
        words, page = seen.read_text().split("\n", 1)
        token = urlsplit(found.address).path.strip("/")
        assert words.startswith("file://")
        assert token not in words
        assert found.address in page
        assert asker(found.address)().status == 200
    assert not Path(words.removeprefix("file://")).exists()


def test_an_end_amid_an_answer_is_quiet(tmp_path):
    """The server told of a task that it had cancelled."""
    with studio("paper", tmp_path) as found, computing_in(found) as begin:
        fine, _ = begin("one")
        found.process.send_signal(signal.SIGINT)
        assert found.process.wait(300) == 0
        assert found.errors() == ""
        assert fine.result().body.keys() & {"superseded", "sentence"}


def requests_of(rng, host, token, bodies):
    """A request, one part in five of it damaged."""
    junk = lambda most: bytes(rng.randrange(256) for _ in range(rng.randrange(most)))  # noqa: E731
    word = lambda sound, *damaged: rng.choice(damaged) if rng.random() < 0.2 else rng.choice(sound)  # noqa: E731
    of_post = [b"edit", b"answer", b"save", b"jobs", b"leave", b"jobs/0/cancel"]
    of_get = [b"", b"jobs", b"files/", b"files/out/x"]
    posted = rng.random() < 0.7
    method = word(
        [b"POST" if posted else b"GET"],
        b"OPTIONS",
        b"HEAD",
        b"CONNECT",
        b"TRACE",
        b"PUT",
        b"get",
        b"",
        b"G\x00T",
        junk(9),
    )
    damaged = [b"jobs/-1/cancel", b"jobs/" + 1500 * b"9" + b"/cancel", b"files/%00", b"files/" + 900 * b"a/", b"files/%ff%fe",
               b"%2e%2e", "²".encode(), b"?" + junk(40)]  # fmt: skip
    damaged = [b"/" + token + b"/" + path for path in damaged]
    damaged += [b"*", b"abc", b"//", b"/", b"host:1", b"http://" + host, junk(20)]
    target = word([b"/" + token + b"/" + path for path in (of_post if posted else of_get)], *damaged)
    lines = [method + b" " + target + b" " + word([b"HTTP/1.1"], b"HTTP/1.0", b"HTTP/9", b"", junk(9))]
    lines += [b"Host: " + host] * word([1], 0, 2)
    lines += [b"Content-Type: application/json"] * word([1], 0)
    lines += word(
        [[], [b"Connection: close"], [b"Expect: 100-continue"]],
        [b"Range: bytes=" + 30 * b"9" + b"-"],
        [b"Upgrade: websocket", b"Connection: upgrade"],
        [b"Origin: null"],
        [b"X: " + junk(30)],
        [b"A" * 70_000],
    )
    body = word(bodies, junk(200)) if posted else b""
    chunks = b"%x\r\n%s\r\n0\r\n\r\n" % (len(body), body) if body else b"0\r\n\r\n"
    length = [b"Content-Length: %d" % len(body)]
    framed = word(
        [(length, body), ([b"Transfer-Encoding: chunked"], chunks)],
        ([b"Content-Length: %d" % (len(body) + 7)], body),
        ([b"Content-Length: -1"], body),
        ([b"Content-Length: 99999999999"], body),
        (["Content-Length: ²".encode("latin-1")], body),
        ([b"Transfer-Encoding: gzip"], body),
        ([b"Transfer-Encoding: chunked", *length], chunks),
        ([b"Transfer-Encoding: chunked"], chunks[:-9]),
        ([b"Transfer-Encoding: chunked"], b"zz\r\n" + chunks),
        ([], body),
    )
    lines, body = lines + framed[0], framed[1]
    sent = word([b"\r\n"], b"\n").join([*lines, b"", b""]) + body
    return word([sent], sent[: rng.randrange(len(sent) + 1)], 2 * sent, sent + junk(50))


@pytest.mark.family(quick=1, full=2)
@pytest.mark.parametrize("seed", range(4))
def test_no_request_is_unforeseen(running, seed):
    rng, parts = random.Random(seed), urlsplit(running.address)
    asked = {"text": PAPER, "tab": "z", "case": "CS-1", "name": "fuzz", "quality": "coarse", "job": {"kind": "none"}}
    values = [None, True, -1, 1e308, [], {}, "\0", "\ud800", 400 * "a", {"kind": {}}, [[]], "case = 3\nname = []", "a.b = 1",
              "[[case]]", "name = 'x'\ncase = [1, {name = 3}]\n[limits]\na = nan", "disc = 1", "[disc]\nof = 3"]  # fmt: skip
    bodies = [
        json.dumps(asked).encode(),
        b"",
        b"{",
        b"[]",
        b"NaN",
        b"\xff\xfe{",
        3000 * b"[",
        b'{"text": 1e999}',
        b"9" * 5000,
    ]
    for _ in range(30):
        changed = dict(asked)
        for name in rng.sample([*asked, "changes", "entry", "key", "value", "remove", "field", "compliance"], 2):
            changed[name] = rng.choice(values)
        bodies.append(json.dumps(changed).encode())
    before = running.errors()
    for number in range(150):
        sent = requests_of(rng, parts.netloc.encode(), parts.path.strip("/").encode(), bodies)
        found = exchanged(running.address, sent)
        assert not re.search(rb"HTTP/1\.1 5", found), (number, sent[:400], found[:400])
        assert running.errors() == before, (number, sent[:400])
    assert running.ask().status == 200
