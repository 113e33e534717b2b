"""Batches of a study that are damaged or another's are set aside with a word and solved again; nothing is executed."""

from __future__ import annotations

import io
import pickle
import shutil
import zipfile
from dataclasses import replace

import h5py
import numpy as np
import pytest
from refusals import error_says

from ltca.commands.program import main
from ltca.errors import CycloError, DamagedFileError
from ltca.quantities import SCHEMA_VERSION
from ltca.reading.drive_file import load_drive
from ltca.studies.execution.storage import PARTS, StudyFolder, read_batch
from ltca.studies.execution.workers import Workers
from ltca.studies.run_study import run_study
from ltca.studies.study import run_batch
from ltca.studies.study_results import read_failures, read_quantity
from ltca.studies.tolerance_study import tolerance_study

RAN = []
FINISHED = ["tolerance", "paper", "--samples", "2", "--positions", "2", "--quantities", "max_pin_load", "--no-figures"]


class Trap:
    """Executed by whoever loads a pickle."""

    def __reduce__(self):
        return RAN.append, ("executed",)


def study_of(seed, samples=40):
    found = tolerance_study(
        load_drive("paper"), case="CS-1", samples=samples, positions=2, seed=seed, quantities=("max_pin_load",)
    )
    return replace(found, batch_positions=30)


@pytest.fixture(scope="module")
def study():
    return study_of(1)


@pytest.fixture(scope="module")
def other():
    return study_of(2)


@pytest.fixture(scope="module")
def solved(study, other):
    return {name: [run_batch(own, number) for number in range(own.batches)] for name, own in
            (("study", study), ("other", other))}  # fmt: skip


@pytest.fixture(scope="module")
def reference(study, tmp_path_factory):
    folder = StudyFolder(path=tmp_path_factory.mktemp("reference"))
    run_study(study, folder, Workers())
    return folder.results.read_bytes()


@pytest.fixture
def interrupted(study, solved, tmp_path):
    """All batches of a study that was interrupted before its end."""
    folder = StudyFolder(path=tmp_path / "out")
    folder.prepare(study, resume=False)
    for result in solved["study"]:
        folder.store(study, result)
    return folder


def member(**arrays):
    """An archive of arrays as numpy writes it."""
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def forged(header, content=b""):
    """An archive of all parts of a batch whose arrays have a header of somebody else's."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name in PARTS:
            archive.writestr(f"{name}.npy", b"\x93NUMPY\x01\x00v\x00" + header.ljust(117) + b"\n" + content)
    return stream.getvalue()


def pickled(_):
    return forged(b"{'descr': '|O', 'fortran_order': False, 'shape': (), }", pickle.dumps(Trap()))


def huge(_):
    return forged(b"{'descr': '<f8', 'fortran_order': False, 'shape': (9000000000000,), }")


def one_bit(content):
    """Of the values, which are stored unpacked: the archive's own checksum is made right again."""
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        parts = {name: archive.read(name) for name in archive.namelist()}
    parts["values.npy"] = parts["values.npy"][:-3] + bytes([parts["values.npy"][-3] ^ 1]) + parts["values.npy"][-2:]
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name, part in parts.items():
            archive.writestr(name, part)
    return stream.getvalue()


def bits(content, place):
    return content[:place] + bytes([content[place] ^ 255]) + content[place + 1 :]


DAMAGES = {
    "empty": lambda content: b"",
    "cut off": lambda content: content[: len(content) // 2],
    "no archive": lambda content: b"not an archive",
    "one array": lambda content: b"\x93NUMPY\x01\x00",
    "lacks parts": lambda content: member(values=np.zeros(3)),
    "a bit of the archive": lambda content: bits(content, content.index(b"values.npy") + 10 + 128 + 20),
    "a bit of a value": one_bit,
    "pickle": pickled,
    "72 TB": huge,
}


@pytest.mark.slow
@pytest.mark.parametrize("damage", DAMAGES)
def test_damaged_batches_are_set_aside(damage, study, interrupted, reference):
    path = sorted(interrupted.path.glob("batches/*.npz"))[0]
    path.write_bytes(DAMAGES[damage](path.read_bytes()))
    told = []
    run_study(study, interrupted, Workers(), resume=True, told=told.append)
    assert RAN == []
    assert interrupted.results.read_bytes() == reference
    assert len(told) == 1
    assert "\n" not in told[0]
    assert "set aside" in told[0]
    assert path.with_suffix(".npz.aside").exists()


@pytest.mark.slow
def test_batches_of_another_study_or_number_are_set_aside(study, other, solved, interrupted, reference):
    """Two studies with different seeds mixed in silence."""
    paths = sorted(interrupted.path.glob("batches/*.npz"))
    assert len(paths) == 3
    foreign = StudyFolder(path=interrupted.path / "foreign")
    foreign.store(other, solved["other"][0])
    (foreign.path / "batches" / "00000000.npz").replace(paths[0])
    paths[1].write_bytes(paths[2].read_bytes())
    told = []
    run_study(study, interrupted, Workers(), resume=True, told=told.append)
    assert ["belongs to another study" in told[0], "is batch 2 of the study" in told[1], len(told)] == [True, True, 2]
    assert interrupted.results.read_bytes() == reference


@pytest.mark.slow
def test_what_is_not_ours_in_the_folder_of_batches_stays(study, interrupted, reference):
    for name in ("notes.txt", "0.npz", "12.npz", "000000x0.npz"):
        (interrupted.path / "batches" / name).write_text("the user's")
    run_study(study, interrupted, Workers(), resume=True)
    assert interrupted.results.read_bytes() == reference
    assert sorted(path.name for path in interrupted.path.glob("batches/*")) == sorted(
        ["notes.txt", "0.npz", "12.npz", "000000x0.npz"]
    )
    assert not interrupted.has_batches()


def test_another_study_does_not_take_an_unfinished_ones_folder(other, interrupted):
    with pytest.raises(CycloError, match="--resume"):
        interrupted.prepare(other, resume=False)
    with pytest.raises(CycloError, match="another study"):
        interrupted.prepare(other, resume=True)
    assert interrupted.has_batches()


def test_another_study_replaces_a_finished_one_only_when_told(study, other, interrupted, reference, solved):
    """A finished study was replaced in silence by one of another seed."""
    run_study(study, interrupted, Workers(), resume=True)
    with error_says(CycloError, "holds a finished study that is another (", "seed", ends="--force to replace it"):
        interrupted.prepare(other, resume=False)
    assert interrupted.results.read_bytes() == reference
    assert interrupted.prepare(study, resume=False) == list(range(study.batches))  # its own it may solve again
    interrupted.store(study, solved["study"][0])
    assert interrupted.prepare(other, resume=False, replace=True) == list(range(other.batches))
    assert not interrupted.has_batches()


def flip(path):
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content)


SPOILT = {
    "one byte": flip,
    "cut off": lambda path: path.write_bytes(path.read_bytes()[:-2000]),
    "empty": lambda path: path.write_bytes(b""),
    "missing": lambda path: path.unlink(),
}


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    out = tmp_path_factory.mktemp("finished") / "out"
    assert main([*FINISHED, "--out", str(out)]) == 0
    return out


@pytest.mark.parametrize("name", ["results.nc", "results.parquet"])
@pytest.mark.parametrize("spoil", SPOILT.values(), ids=SPOILT)
def test_a_finished_study_that_is_damaged_is_not_believed(spoil, name, finished, tmp_path, capsys):
    """One byte of results.nc was told as a result, half a file as an unforeseen fault, a missing table not at all."""
    out = shutil.copytree(finished, tmp_path / "out")
    spoil(out / name)
    capsys.readouterr()
    assert main([*FINISHED, "--out", str(out), "--resume"]) == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.count("\n") == 1
    assert f"{out / name}: " in said.err
    assert "solve it again with --force" in said.err


@pytest.mark.parametrize("name", ["study.json", "results.nc"])
def test_a_damaged_study_is_solved_again_when_told_to(name, finished, tmp_path):
    out = shutil.copytree(finished, tmp_path / "out")
    (out / name).write_bytes(b"{")
    assert main([*FINISHED, "--out", str(out), "--force"]) == 0
    for file in ("study.json", "results.nc", "results.parquet", "summary.json"):
        assert (out / file).read_bytes() == (finished / file).read_bytes()


def test_results_that_cannot_be_read_are_told_in_a_line(finished, tmp_path):
    """Without a manifest, as in Python, there is no checksum to find it by."""
    folder = StudyFolder(path=shutil.copytree(finished, tmp_path / "out"))
    folder.results.write_bytes(folder.results.read_bytes()[:-2000])
    for read in (lambda: read_quantity(folder.results, "max_pin_load"), lambda: read_failures(folder.results)):
        with error_says(
            DamagedFileError, "results.nc: cannot be read as the results of a study (netCDF-4): ", "--force"
        ):
            read()


@pytest.mark.slow
def test_a_finished_study_can_be_resumed_again_and_again(tmp_path, capsys):
    """The first --resume took the plan away as a file of the last run: then the folder held 'no study'."""
    words = ["tolerance", "paper", "--samples", "2", "--positions", "2", "--no-figures", "--out", str(tmp_path)]
    for resume in ([], ["--resume"], ["--resume"]):
        assert main([*words, *resume]) == 0
        assert (tmp_path / "study.json").exists()
    for more, told in (
        (["--seed", "9", "--resume"], "holds another study"),
        (["--seed", "9"], "holds a finished study that is another"),
        (["--resume", "--force"], "--resume and --force: give one of them"),
    ):
        capsys.readouterr()
        assert main([*words, *more]) == 2
        assert told in capsys.readouterr().err
    assert main([*words, "--seed", "9", "--force"]) == 0


@pytest.mark.parametrize("text", ["", "{", "[]", '"a"', "{}"])
def test_a_damaged_plan_is_told_in_a_line(text, study, interrupted):
    (interrupted.path / "study.json").write_text(text)
    with pytest.raises(DamagedFileError, match="plan of a study"):
        interrupted.prepare(study, resume=True)


def test_a_batch_is_read_as_it_was_written(study, interrupted, solved):
    for number, result in enumerate(solved["study"]):
        found = read_batch(interrupted.path / "batches" / f"{number:08d}.npz", study)
        np.testing.assert_array_equal(found.values, result.values)
        np.testing.assert_array_equal(found.factors, result.factors)
        assert found.messages == result.messages


def test_results_of_a_later_schema_are_refused(study, interrupted):
    """The dataset of a study says its schema version, as that of a run does; a later one may mean other things."""
    interrupted.finish(study)
    with h5py.File(interrupted.results, "r+") as file:
        assert file.attrs["schema_version"] == SCHEMA_VERSION
        file.attrs["schema_version"] = SCHEMA_VERSION + 1
    with error_says(DamagedFileError, f"schema version {SCHEMA_VERSION + 1}", f"up to {SCHEMA_VERSION}: update"):
        read_quantity(interrupted.results, "max_pin_load")
