"""Errors the suite raises on purpose; the command line turns them into one message and an exit status."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache
from typing import Any, ClassVar, Self

MOST_TOLD = 10
"""Mistakes that are listed; of more the number is given."""


class Problem(str):
    """Sentence about one field of a drive, with the field as data: it names field, value, bound and unit.

    Attributes
    ----------
    path : str
        The field; empty where the sentence alone is known, as are the others then.
    subject : str
        Field and value, as the sentence begins.
    said : str
        What is said of it, behind the colon.
    consequence : str
        What would go wrong beyond the bound; empty where the sentence does not say it apart from the bound.
    trouble : str
        What is wrong, said before the bound; empty as well.
    bound : tuple of str and float, optional
        Relation ("at most in size" is that of both signs) and number of the bound, in the unit of the sentence; None where no
        number is known.

    Examples
    --------
    >>> bound = ("less than", 14.0)
    >>> problem = Problem.of("disc.gap", "= 20 mm", "must be less than 14 mm", otherwise="discs overlap", bound=bound)
    >>> problem
    'disc.gap = 20 mm: must be less than 14 mm, or discs overlap'
    >>> problem.path, problem.consequence, problem.bound
    ('disc.gap', 'discs overlap', ('less than', 14.0))
    """

    path: str = ""
    subject: str = ""
    said: str = ""
    consequence: str = ""
    trouble: str = ""
    bound: tuple[str, float] | None = None

    @classmethod
    def of(
        cls,
        path: str,
        value: str,
        said: str,
        *,
        otherwise: str = "",
        trouble: str = "",
        shown: str = "",
        bound: tuple[str, float] | None = None,
    ) -> Self:
        """Return the sentence on a field and its value, "= 4 mm" or empty; `shown` is what the field is called in it.

        A bound that is `said` is followed by what goes wrong `otherwise`, or comes behind the `trouble`; `bound` is its number.
        """
        subject = f"{shown or path} {value}".rstrip()
        words = f"{said}, or {otherwise}" if otherwise else f"{trouble}; {said}" if trouble else said
        problem = cls(f"{subject}: {words}")
        problem.path, problem.subject, problem.said = path, subject, words
        problem.consequence, problem.trouble, problem.bound = otherwise, trouble, bound
        return problem

    def is_about(self, path: str) -> bool:
        """Tell whether the sentence is about a field, or about the table or array that it is in."""
        return path == self.path or (bool(self.path) and path.startswith(f"{self.path}."))

    def reason(self, cause: str) -> str:
        """Return what is wrong without the bound, for a sentence about the field `cause`."""
        if self.consequence:
            return self.consequence
        words = self.trouble or self.said or str(self)
        return f"{self.subject}: {words}" if self.subject and self.path != cause else words

    def reworded(self, reword: Callable[[str], str]) -> Self:
        """Return the sentence with other words, as of the paths of a single disc."""
        problem = type(self)(reword(self))
        for name in ("path", "subject", "said", "consequence", "trouble"):
            setattr(problem, name, reword(getattr(self, name)))
        problem.bound = self.bound
        return problem

    def within(self, path: str, words: str) -> Problem:
        """Return the sentence behind words about the field under which it holds, as a temperature."""
        problem = Problem(f"{words}: {self}")
        problem.path, problem.consequence, problem.bound = path, self.consequence, self.bound
        problem.trouble = f"{words}: {self.subject}: {self.trouble}" if self.trouble else ""
        return problem


class CycloError(Exception):
    """Base class of errors with a message for the user.

    Examples
    --------
    >>> import ltca
    >>> try:
    ...     ltca.load_drive("papre")
    ... except CycloError as error:
    ...     error.exit_status
    2
    """

    exit_status: ClassVar[int] = 2
    """What the program ends with: 2 for wrong input, 1 for a fault or what has no answer."""


class DriveError(CycloError):
    """The drive definition is wrong.

    Parameters
    ----------
    problems : sequence of str
        One complete sentence per mistake: field, value, bound and unit.
    source : str, optional
        Where the definition came from (a file name).
    beside : str, optional
        What was not checked.

    Examples
    --------
    >>> import ltca
    >>> try:
    ...     ltca.load_drive("paper").cases["CS-1"].with_fields({"disc.thickness": -1.0})
    ... except DriveError as error:
    ...     len(error.problems), "disc.thickness" in error.problems[0]
    (1, True)
    """

    def __init__(self, problems: Sequence[str], source: str = "", beside: str = "") -> None:
        self.problems = tuple(dict.fromkeys(printable(problem) for problem in problems))
        self.source = source
        head = f"{printable(source)}: " if source else ""
        count = len(self.problems)
        if count == 1:
            text = head + self.problems[0] + (f" ({beside})" if beside else "")
        else:
            told = f"{count} mistakes" if count <= MOST_TOLD else f"{count} mistakes, the first {MOST_TOLD}"
            told += f" ({beside})" if beside else ""
            text = f"{head}{told}\n" + "\n".join(f"  {problem}" for problem in self.problems[:MOST_TOLD])
        super().__init__(text)


class OverloadError(DriveError):
    """The torque cannot be carried: contacts would be wider than the bodies are curved."""


class FaultError(CycloError):
    """A fault that is not of the input, as a full disc or workers that died."""

    exit_status = 1


class PlaceError(CycloError):
    """A file or folder that was asked for cannot be used: another process writes to it, or nobody may."""


class DamagedFileError(CycloError):
    """A file is damaged, or is not what it should be.

    Examples
    --------
    >>> import ltca, pathlib, tempfile
    >>> drive = ltca.load_drive("paper").cases["CS-1"]
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     (path := pathlib.Path(folder) / "coefficients.nc").write_text("no coefficients")
    ...     try:
    ...         ltca.analyse(drive, 1, compliance="fe", coefficients=path)
    ...     except DamagedFileError as error:
    ...         error.exit_status
    15
    2
    """


class ConvergenceError(CycloError):
    """An iteration ended without an answer.

    Parameters
    ----------
    message : str
        What did not converge, and where.
    history : sequence of float
        The residual after each iteration, in the unit the message states.

    Notes
    -----
    ``partial`` holds what has an answer where some positions have none, marked as such; None where nothing has.

    Examples
    --------
    >>> error = ConvergenceError("the balance at 20° has not converged", [1.0, 0.5])
    >>> error.exit_status, error.partial, str(error)
    (1, None, 'the balance at 20° has not converged; last residuals: 1, 0.5')
    """

    exit_status = 1

    def __init__(self, message: str, history: Sequence[float] = ()) -> None:
        self.partial: Any = None
        self.cause = ""
        self.history = tuple(float(value) for value in history)
        tail = ", ".join(f"{value:.3g}" for value in self.history[-8:])
        super().__init__(f"{message}; last residuals: {tail}" if tail else message)

    def add(self, cause: str) -> None:
        """Put before the message what was asked for: field, value, unit."""
        self.cause = cause

    def __str__(self) -> str:
        """Say what did not converge."""
        told = super().__str__()
        return f"{self.cause}: {told}" if self.cause else told


def shortened(value: Any, most: int = 60) -> str:
    """Return a value as it is written, cut when it is long; texts in quotes, without control characters.

    Examples
    --------
    >>> shortened("a\\nb"), shortened(4.5)
    ("'a\\\\nb'", '4.5')
    """
    try:
        if isinstance(value, str) and len(value) > most - 2:
            value = f"{value[: most - 5]}..."
        text = repr(value) if isinstance(value, str) else str(value)
    except (ValueError, RecursionError):  # whole numbers of thousands of digits, tables in tables
        text = f"a {type(value).__name__} too long to print"
    text = printable(text)
    return text if len(text) <= most else text[: most - 3] + "..."


def as_sentences(error: str, most: int = 300) -> str:
    """Return a message of several lines as one, cut between words when it is long.

    Parameters
    ----------
    error : str
        What an error says: of several mistakes the first line has their number, each other one a mistake.
    most : int
        Signs.

    Examples
    --------
    >>> as_sentences("2 mistakes\\n  a: too small\\n  b: too large")
    '2 mistakes: a: too small; b: too large'
    >>> as_sentences("must be at most 4 mm", 15)
    'must be at …'
    """
    head, *others = [" ".join(line.split()) for line in error.splitlines() if line.strip()] or [""]
    text = f"{head}: {'; '.join(others)}" if others else head
    return text if len(text) <= most else text[: most - 1].rpartition(" ")[0] + " …"


def printable(text: str) -> str:
    """Return a text without control characters, which would act on the terminal; lines are kept apart by a space."""
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() else " " if sign.isspace() else "\ufffd" for sign in text)


def one_line(error: BaseException) -> str:
    """Return what an exception of a library says on one line, cut when it is long; its kind where it says nothing."""
    return printable(" ".join(str(error).split()))[:200] or type(error).__name__


def told_twice(names: Sequence[str]) -> str:
    """Return the first of some names that is there twice, empty when none is.

    Examples
    --------
    >>> told_twice(["CS-1", "CS-3", "CS-1"])
    'CS-1'
    """
    return next((name for place, name in enumerate(names) if name in names[:place]), "")


def counted(number: int, things: str) -> str:
    """Return a number of things, whose name is a plural in "s" or "ies".

    Examples
    --------
    >>> counted(1, "values"), counted(0, "entries"), counted(1, "entries")
    ('1 value', '0 entries', '1 entry')
    """
    one = things.removesuffix("ies") + "y" if things.endswith("ies") else things.removesuffix("s")
    return f"{number} {one if number == 1 else things}"


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return a question after the name that was meant, with a space before it, or nothing when none is near.

    Examples
    --------
    >>> did_you_mean("pin_radus", ["pin_radius", "hole_radius"])
    '; did you mean `pin_radius`?'
    """
    found = nearest(name, known)
    return f"; did you mean `{found}`?" if found else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """Return the known name nearest to one that is not known, empty when none is near."""
    return _nearest(name[:80].casefold(), tuple(known))


@lru_cache(maxsize=4096)
def _nearest(name: str, known: tuple[str, ...]) -> str:
    from difflib import get_close_matches

    if not known:
        return ""
    spelled = {text.casefold(): text for text in known}
    swapped = [text for text in spelled if sorted(text) == sorted(name)]
    found = swapped or get_close_matches(name, spelled, n=1, cutoff=0.8 if len(name) < 5 else 0.7)
    # CS-9 is no misspelt CS-6: another number is another thing.
    if not found or (found[0] != name and _letters(found[0]) == _letters(name)):
        return ""
    return spelled[found[0]]


def _letters(name: str) -> str:
    return "".join(sign for sign in name if not sign.isdigit())
