"""Coefficient files: every class of damage is refused in a line, in the cache it is derived again with a word."""

from __future__ import annotations

import shutil

import h5py
import numpy as np
import pytest
from refusals import error_says

from ltca.commands.program import main
from ltca.compliance import coefficient_files
from ltca.compliance.coefficient_files import cached_file, find_case_coefficients, find_coefficients
from ltca.compliance.coefficients import load_coefficients
from ltca.contact.round_bodies import held_ring_approach
from ltca.drive.single_discs import single_discs
from ltca.errors import CycloError, DamagedFileError
from ltca.output import derived_files
from ltca.output.netcdf import write_netcdf
from ltca.output.provenance import code_hash
from ltca.reading.coefficient_file import CHECKSUM, checksum_of, read_coefficients, write_coefficients
from ltca.reading.coefficient_laws import near_field_unit
from ltca.reading.drive_file import load_drive
from ltca.testing.closed_form_bodies import closed_form_coefficients


def closed_form(drive):
    return closed_form_coefficients(drive, half_width=0.05, depth=300.0)


@pytest.fixture(scope="module")
def drive(paper_cases):
    return paper_cases["CS-1"]


@pytest.fixture(scope="module")
def sound(drive, tmp_path_factory):
    """A sound file with a checksum."""
    return write_coefficients(closed_form(drive), tmp_path_factory.mktemp("sound") / "coefficients.nc")


@pytest.fixture
def derived(monkeypatch, tmp_path):
    """Bodies in closed form in place of finite elements, an empty cache, and the list of what was derived."""
    made = []

    def derive(drive, *, bodies, processes, store):
        made.append(drive.name)
        store(closed_form(drive))

    code_hash("ltca", "fem")  # by the usual cache, where it is kept
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.delenv(derived_files.INSTEAD, raising=False)
    monkeypatch.setattr(coefficient_files, "derivation", lambda: derive)
    return made


def bits(content, first, step):
    damaged = bytearray(content)
    for place in range(first, len(damaged), step):
        damaged[place] ^= 1
    return bytes(damaged)


FILES = {
    "empty": lambda content: b"",
    "text": lambda content: b"not netCDF",
    "cut off": lambda content: content[: len(content) // 2],
    "a bit each 1001 bytes": lambda content: bits(content, 500, 1001),
    "zeros": lambda content: bytes(len(content)),
}


@pytest.mark.parametrize("damage", FILES)
def test_damaged_bytes_are_refused(damage, drive, sound, tmp_path):
    """One flipped bit for each 1001 bytes gave 3115 N for 3121 N, exit status 0."""
    path = tmp_path / "damaged.nc"
    path.write_bytes(FILES[damage](sound.read_bytes()))
    with pytest.raises(DamagedFileError) as refused:
        load_coefficients(path, drive)
    assert "\n" not in str(refused.value)


@pytest.mark.slow
def test_any_bit_of_a_number_is_seen(drive, sound, tmp_path):
    """By the checksum: one bit somewhere in the matrix of the disc breaks no law."""
    content, rng = sound.read_bytes(), np.random.default_rng(5)
    with h5py.File(sound) as file:
        matrix = file["disc_approach"].id
        first, size = matrix.get_chunk_info(0).byte_offset, matrix.get_chunk_info(0).size
    path = tmp_path / "damaged.nc"
    for _ in range(10):
        place = first + int(rng.integers(size))
        path.write_bytes(content[:place] + bytes([content[place] ^ (1 << int(rng.integers(8)))]) + content[place + 1 :])
        with pytest.raises(DamagedFileError) as caught:
            load_coefficients(path, drive)
        assert any(words in str(caught.value) for words in ("checksum", "no finite numbers", "cannot be read"))


def scaled(name, factor):
    def change(file):
        file[name][...] = factor * file[name][...]

    return change


def linked(file):

    del file["pin_approach"]
    file["pin_approach"] = h5py.ExternalLink("other.nc", "/pin_approach")


def soft(file):

    del file["pin_approach"]
    file["pin_approach"] = h5py.SoftLink("/pin_half_width")


def elsewhere(file):
    del file["race_approach"]
    file.create_dataset("race_approach", shape=(24,), dtype="f8", external=[("other.bin", 0, 192)])


def huge(file):
    del file["disc_approach"]
    file.create_dataset("disc_approach", shape=(3_000_000, 3_000_000), dtype="f8", chunks=(1000, 1000))


# What somebody made who takes no checksum: schema and laws have to see it.
CONTENTS = {
    "plane": (lambda file: file.attrs.__setitem__("plane", "banana"), "plane = banana: must be strain or stress"),
    "matrix × 10": (scaled("disc_approach", 10.0), "near field"),
    "pin × 10": (scaled("pin_approach", 10.0), "near field"),
    "roller × 1.01": (scaled("roller_approach", 1.01), "compressed cylinder"),
    "race × 10": (scaled("race_approach", 10.0), "near field"),
    "matrix negative": (scaled("disc_approach", -1.0), "smallest eigenvalue"),
    "a bit asymmetric": (lambda file: file["disc_approach"].__setitem__((3, 40), 0.0), "symmetry"),
    "moved": (lambda file: file["station_x"].__setitem__(7, file["station_x"][7] + 0.01), "half-widths of its patch"),
    "moved back": (
        lambda file: file["station_x"].__setitem__(7, file["station_x"][7] - 0.01),
        "half-widths of its patch",
    ),
    "not a number": (lambda file: file["race_approach"].__setitem__(3, np.nan), "no finite numbers"),
    "thickness": (lambda file: file.attrs.__setitem__("thickness", 118.0), "must be 11.8 as in shape"),
    "missing": (lambda file: file.__delitem__("race_approach"), "race_approach"),
    "external link": (linked, "is a link to other.nc, which is not followed"),
    "soft link": (soft, "is a link to another place"),
    "external storage": (elsewhere, "lies in another file"),
    "72 TB": (huge, "it declares 7.2e+13 bytes"),
}


def labelled(name, labels):
    def change(dataset):
        return dataset.assign_coords({name: labels(dataset.sizes[name])})

    return change


def of_rings(drive):
    """Pin and race as rings held inside, as derived files have them."""
    dataset = closed_form(drive)
    dataset.attrs |= {"core_radius": 2.0, "race_bore_radius": 10.0}
    for body, inner, outer in (
        ("pin", 2.0, drive.pin_wheel.pin_radius),
        ("race", 10.0, drive.crank_bearing.inner_race_radius),
    ):
        own = dataset[f"{body}_approach"]
        angle = 2.0 * np.pi * np.arange(own.size) / own.size
        kolosov = 3.0 - 4.0 * dataset.attrs[f"{body}_poisson_ratio"]
        ring = held_ring_approach(inner, outer, float(dataset[f"{body}_half_width"]), kolosov, angle)
        dataset[f"{body}_approach"] = (own.dims, near_field_unit(dataset, body) * ring.reshape(own.shape))
    return dataset


@pytest.mark.parametrize(
    ("attribute", "field", "default"),
    [("core_radius", "pin_wheel.core_radius", 2.0), ("race_bore_radius", "crank_bearing.race_bore_radius", 10.0)],
)
def test_a_file_of_other_supports_is_refused(attribute, field, default, drive, tmp_path):
    """A file may say on which core and bore it held pins and race; the shape alone did not tell such files apart."""
    path, other = tmp_path / "coefficients.nc", 0.9 * default
    own = closed_form(drive)
    own.attrs[attribute] = other  # closed forms of half-planes; laws of rings are not what is looked at
    write_netcdf(own, path)
    told = f"belongs to {field} = {other:g} mm, not to the {default:g} mm of paper: give the drive that"
    with error_says(CycloError, told):
        load_coefficients(path, drive, lawful=False)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("change", "told"),
    {
        **{
            f"{body} × {factor:g}": (
                lambda dataset, body=body, factor=factor: dataset.assign(
                    {f"{body}_half_width": factor * dataset[f"{body}_half_width"]}
                ),
                told,
            )
            for body, told in (("pin", "pin against the held ring"), ("race", "race against the held ring"))
            for factor in (10.0, 0.1, 1.1)
        },
        "outer end of the roller": (
            lambda dataset: dataset.assign(roller_half_width=dataset["roller_half_width"] * [1.0, 10.0]),
            "roller against the compressed cylinder",
        ),
        "core": (lambda dataset: dataset.assign_attrs(core_radius=20.0), "pin against the held ring is nan"),
        "stations": (labelled("station", lambda count: np.arange(count)[::-1]), "station must number its entries"),
        "ends": (labelled("roller_end", lambda count: ["outer", "inner"]), "or inner, outer"),
        "loaded": (labelled("station_loaded", lambda count: ["a"] * count), "station_loaded must number its entries"),
    }.values(),
)
def test_half_widths_and_labels_are_checked(change, told, drive, tmp_path):
    """`race_half_width` or `pin_half_width` ten times too large in a file without checksum passed every law."""
    path = tmp_path / "coefficients.nc"
    sound = of_rings(drive).assign_coords(station=np.arange(1, closed_form(drive).sizes["station"] + 1))
    sound = sound.assign_coords(roller_end=["inner", "outer"])
    write_netcdf(sound, path)
    load_coefficients(path, drive)
    write_netcdf(change(sound), path)
    with error_says(DamagedFileError, told) as refused:
        load_coefficients(path, drive)
    assert "\n" not in str(refused.value)


@pytest.mark.parametrize("name", CONTENTS)
def test_wrong_contents_are_refused(name, drive, sound, tmp_path):
    """A matrix ten times too large gave −26 %, plane = "banana" +2.9 %, both with exit status 0."""

    change, message = CONTENTS[name]
    path = tmp_path / "wrong.nc"
    shutil.copy(sound, path)
    with h5py.File(path, "r+") as file:
        del file.attrs[CHECKSUM]
        change(file)
    with error_says(DamagedFileError, message) as refused:
        load_coefficients(path, drive)
    assert "\n" not in str(refused.value)


def pair(row, column, added):
    """A pair of entries of the matrix of the disc, changed by units of the near field."""

    def change(contents, unit):
        for place in {(row, column), (column, row)}:
            contents["disc_approach"].values[place] += added * unit

    return change


def multiplied(name, place=..., factor=1.05):
    def change(contents, unit):
        contents[name].values[place] *= factor

    return change


# Changes of contents whose checksum is made anew, and the law that tells them.
FORGED = {
    "a pair of entries": (pair(100, 300, 3.0), "entry out of line"),
    "one entry": (multiplied("disc_approach", (3, 40), 0.9), "symmetry of the stored matrices"),
    "the whole matrix": (multiplied("disc_approach"), "near field, disc"),
    "a pair across a wall": (pair(10, 700, -3.0), "entry out of line"),
    "a patch on itself": (pair(640, 640, 3.0), "entry out of line"),
    "pin": (multiplied("pin_approach"), "near field, pin, roller, race"),
    "roller": (multiplied("roller_approach"), "roller against the compressed cylinder"),
    "race": (multiplied("race_approach", 0), "near field, pin, roller, race"),
    "stresses by some loads": (multiplied("disc_stress", np.s_[:, :312], 3.0), "stress left by even pressure"),
    "resultants": (multiplied("disc_resultant", (2, 5), 0.9), "resultants of the patches"),
    "what it states": (lambda contents, unit: contents.attrs.update(rigid_residual=1e-3), "rigid motions"),
}


@pytest.fixture(scope="module")
def shipped():
    """A shipped drive of one disc, and its coefficients by finite elements: 13 × 48 stations on the flank, 48 on each wall."""
    (drive, *_) = single_discs(next(iter(load_drive("robot-joint").cases.values())))
    path = coefficient_files.shipped_file(drive)
    assert path is not None
    return drive, path


@pytest.mark.parametrize("name", FORGED)
@pytest.mark.family(quick=3)
def test_a_cached_file_whose_checksum_was_changed_with_it_is_found_out(name, shipped, tmp_path):
    """Files in the cache were read by their checksum alone: one matrix entry, and another load, with exit status 0."""
    change, law = FORGED[name]
    drive, sound = shipped
    contents = read_coefficients(sound, lawful=False).to_xarray().copy(deep=True)
    change(contents, near_field_unit(contents, "disc"))
    path = write_coefficients(contents, tmp_path / "cached.nc")
    with error_says(DamagedFileError, law) as refused:
        load_coefficients(path, drive, lawful="quick")
    assert str(refused.value).startswith(f"{path}: breaks laws")
    assert "\n" not in str(refused.value)


def test_a_forged_entry_of_the_cache_is_derived_again_with_a_word(drive, derived, capsys):
    first = find_coefficients(drive)
    path = cached_file(drive)
    forged = read_coefficients(path, lawful=False).to_xarray().copy(deep=True)
    multiplied("roller_approach", factor=1.01)(forged, 1.0)
    write_coefficients(forged, path)
    capsys.readouterr()
    np.testing.assert_array_equal(find_coefficients(drive).roller, first.roller)
    said = capsys.readouterr().err.splitlines()[0]
    assert said.startswith(f"warning: {path}: breaks laws")
    assert "roller against the compressed cylinder" in said
    assert said.endswith("; derived again")
    assert len(derived) == 2


def test_shipped_files_keep_the_quick_laws():
    for path in sorted(coefficient_files.SHIPPED.glob("*.nc")):
        assert read_coefficients(path, lawful="quick").attrs[CHECKSUM]


@pytest.mark.slow
def test_a_damaged_entry_of_the_cache_is_derived_again_with_a_word(drive, derived, capsys):
    first = find_coefficients(drive)
    path = cached_file(drive)
    content = path.read_bytes()
    for damaged in (content[:-2000], bits(content, 3000, 5000), b""):
        path.write_bytes(damaged)
        capsys.readouterr()
        np.testing.assert_array_equal(find_coefficients(drive).disc, first.disc)
        said = capsys.readouterr().err.splitlines()
        assert said[0].startswith(f"warning: {path}: ")
        assert said[0].endswith("; derived again")
    assert len(derived) == 4


def test_a_damaged_file_is_refused_beside_a_sound_one(drive, sound, tmp_path):
    (tmp_path / "damaged.nc").write_bytes(sound.read_bytes()[:-2000])
    with pytest.raises(DamagedFileError, match=r"damaged\.nc"):
        find_coefficients(drive, [tmp_path / "damaged.nc", sound])


@pytest.mark.slow
def test_an_unwritable_cache_is_told_before_the_derivation(drive, derived, tmp_path, monkeypatch, capsys):
    """It derived for 48 s and then failed. What it has is used; what is derived is used and not kept."""
    (tmp_path / "file").touch()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(derived_files.atexit, "register", lambda *arguments: kept.append(arguments))
    kept = []
    found = find_case_coefficients({"CS-1": drive})
    said = capsys.readouterr().err.splitlines()
    assert "cannot be written (Not a directory): what is derived is used but not kept" in said[0]
    assert said[1].startswith("deriving")
    assert found["CS-1"].fingerprint == drive.shape_fingerprint()
    find_coefficients(drive)
    assert derived == [drive.name]  # kept for this run
    ((forget, folder, process),) = kept
    forget(folder, process)
    assert not cached_file(drive).exists()


@pytest.mark.slow
def test_caches_are_keyed_by_the_code(drive, derived, monkeypatch):
    """They were keyed by the version alone, and after a change of the code its old answers came back."""
    find_coefficients(drive)
    find_coefficients(drive)
    assert len(derived) == 1
    monkeypatch.setattr(derived_files, "code_hash", lambda *packages: "another code")
    find_coefficients(drive)
    assert len(derived) == 2


@pytest.mark.slow
def test_the_checksum_is_of_the_content_not_of_its_storage(drive, sound, tmp_path):
    dataset = read_coefficients(sound).to_xarray()
    packed = tmp_path / "packed.nc"
    dataset.assign_attrs({CHECKSUM: checksum_of(dataset)}).to_netcdf(
        packed, engine="h5netcdf", encoding={"disc_approach": {"zlib": True}}
    )
    assert read_coefficients(packed).attrs[CHECKSUM] == read_coefficients(sound).attrs[CHECKSUM]
    assert checksum_of(dataset.assign_attrs(plane="stress")) != checksum_of(dataset)
    assert checksum_of(dataset.drop_vars("pin_approach")) != checksum_of(dataset)


FOREIGN = {
    "notes": lambda dataset, path: path.write_text("notes"),
    "empty": lambda dataset, path: path.touch(),
    "results of a run": lambda dataset, path: write_netcdf(dataset[["station_x"]].assign_attrs({CHECKSUM: "a"}), path),
    "another code's": write_netcdf,
    "link": lambda dataset, path: path.symlink_to(write_coefficients(dataset, path.with_name("elsewhere.nc"))),
}


@pytest.mark.parametrize("make", FOREIGN.values(), ids=FOREIGN)
def test_a_file_that_is_no_derivation_is_not_overwritten(make, drive, tmp_path, monkeypatch, capsys):
    """`cyclo derive --out notes.txt` put coefficients in the place of the notes."""
    monkeypatch.setattr("fem.coefficients.dataset.derive_coefficients", lambda *args, **options: pytest.fail("derived"))
    out = tmp_path / "notes.txt"
    make(closed_form(drive), out)
    before = out.read_bytes()
    assert main(["derive", "paper", "--out", str(out)]) == 2
    assert capsys.readouterr().err == (
        f"cyclo: error: --out {out}: is there and is no coefficient file that cyclo derive wrote: move it, or choose another "
        "place\n"
    )
    assert out.read_bytes() == before


def test_a_derivation_takes_the_place_of_another(drive, sound, tmp_path, monkeypatch):
    monkeypatch.setattr(
        "fem.commands.derive._derive", lambda *given: write_coefficients(closed_form(drive), given[-1]) and 0
    )
    out = shutil.copy(sound, tmp_path / "c.nc")
    for _ in range(2):
        assert main(["derive", "paper", "--out", str(out)]) == 0
