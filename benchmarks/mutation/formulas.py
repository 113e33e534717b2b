"""Mutations of formulas in the sources.

Only numerical code is mutated: no strings, messages, annotations, figures, pages or arguments of commands. Line numbers of the
file are preserved, so that the coverage map remains valid.
"""

from __future__ import annotations

import ast
import random
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

PACKAGES = ("ltca", "fem", "validation")
LEFT_OUT = ("commands", "figures", "pictures", "page", "report", "output", "testing", "export")
"""Folders that are not mutated: text, pictures, files, and the test utilities in ``testing``."""

ARITHMETIC = {
    ast.Add: ast.Sub,
    ast.Sub: ast.Add,
    ast.Mult: ast.Div,
    ast.Div: ast.Mult,
    ast.Pow: ast.Mult,
    ast.Mod: ast.Add,
}
COMPARISONS = {
    ast.Lt: ast.GtE, ast.GtE: ast.Lt, ast.Gt: ast.LtE, ast.LtE: ast.Gt, ast.Eq: ast.NotEq, ast.NotEq: ast.Eq,
}  # fmt: skip
PAIRS = (
    ("min", "max"), ("minimum", "maximum"), ("argmin", "argmax"), ("sin", "cos"), ("floor", "ceil"), ("any", "all"),
    ("real", "imag"), ("zeros", "ones"), ("zeros_like", "ones_like"),
)  # fmt: skip
EXCHANGED = {
    **dict(PAIRS), **{other: one for one, other in PAIRS},
    "sum": "max", "mean": "max", "exp": "sqrt", "log": "sqrt", "hypot": "maximum", "cumsum": "sort", "tan": "sin",
}  # fmt: skip
DROPPED = {"abs", "sqrt", "conj", "sign", "sort", "log1p", "expm1"}
"""Functions of one argument that are replaced by their argument."""
ORDER_MATTERS = {"arctan2", "divide", "subtract", "clip", "where", "power", "cross", "searchsorted"}
TOLERANCES_BELOW = 2e-4


@dataclass(frozen=True, slots=True)
class Mutant:
    """A mutated formula.

    Attributes
    ----------
    path : str
        File, relative to the tree.
    line, end_line : int
        Lines of the statement; of its header for a compound statement.
    start, stop : int
        Position of the replaced text in the file, in characters.
    before, after : str
        Original text and replacement.
    text : str
        Source line.
    name : str
        Name bound by a statement executed at import; "" otherwise.
    scope : tuple of int
        First and last line of the enclosing function; (0, 0) at module and class level.
    """

    path: str
    line: int
    end_line: int
    start: int
    stop: int
    before: str
    after: str
    text: str
    name: str
    scope: tuple[int, int]

    @property
    def key(self) -> str:
        """Identifier that does not depend on changes elsewhere in the file."""
        return f"{self.path} | {self.text} | {self.before} → {self.after}"

    def apply(self, tree: Path) -> str:
        """Return the mutated source of the file."""
        source = (tree / self.path).read_text(encoding="utf-8")
        if source[self.start : self.stop] != self.before:
            raise ValueError(f"{self.path}:{self.line} is not the source this mutant was made from")
        return source[: self.start] + self.after + source[self.stop :]


def source_files(tree: Path, packages: tuple[str, ...] = PACKAGES) -> list[Path]:
    """Return the files with numerical code, sorted, relative to the tree."""
    found = [path.relative_to(tree) for package in packages for path in sorted((tree / package).rglob("*.py"))]
    return [path for path in found if not set(path.parts[:-1]) & set(LEFT_OUT) and path.name != "__init__.py"]


def all_mutants(tree: Path, packages: tuple[str, ...] = PACKAGES) -> list[Mutant]:
    """Return every mutant of the packages in the order of the sources."""
    return [mutant for path in source_files(tree, packages) for mutant in _mutants_of(tree, path)]


def draw_mutants(tree: Path, packages: tuple[str, ...], count: int, seed: int) -> list[Mutant]:
    """Return a reproducible random selection, with at most one mutant per line."""
    everything = all_mutants(tree, packages)
    order = random.Random(seed).sample(range(len(everything)), len(everything))
    chosen: dict[tuple[str, int], Mutant] = {}
    for number in order:
        mutant = everything[number]
        chosen.setdefault((mutant.path, mutant.line), mutant)
        if len(chosen) == count:
            break
    return list(chosen.values())


def _mutants_of(tree: Path, path: Path) -> list[Mutant]:
    source = (tree / path).read_text(encoding="utf-8")
    walker = _Walker(source, str(path))
    walker.visit(ast.parse(source))
    return walker.found


class _Walker(ast.NodeVisitor):
    """Visit the formulas of a file and leave out what is none."""

    def __init__(self, source: str, path: str) -> None:
        self.source, self.path = source, path
        self.lines = source.splitlines()
        # ast counts columns in UTF-8 bytes.
        self.encoded = [line.encode() for line in source.splitlines(keepends=True)]
        self.begins = [0]
        for line in source.splitlines(keepends=True):
            self.begins.append(self.begins[-1] + len(line))
        self.found: list[Mutant] = []
        self.statement: tuple[int, int] = (1, 1)
        self.scope: tuple[int, int] = (0, 0)
        self.name = ""

    def visit(self, node: ast.AST) -> None:
        if isinstance(node, ast.stmt):
            outer = self.statement
            body = getattr(node, "body", None)
            end = body[0].lineno - 1 if isinstance(body, list) and body else node.end_lineno or node.lineno
            self.statement = (node.lineno, max(node.lineno, end))
            super().visit(node)
            self.statement = outer
            return
        for after in self._replacements(node):
            self._add(node, after)
        super().visit(node)

    # Nodes that are not mutated.
    def visit_JoinedStr(self, node: ast.JoinedStr) -> None:
        """Text."""

    def visit_Raise(self, node: ast.Raise) -> None:
        """A message."""

    def visit_Assert(self, node: ast.Assert) -> None:
        """For mypy."""

    def visit_Import(self, node: ast.Import) -> None:
        """Nothing to break."""

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        """Nothing to break."""

    def visit_If(self, node: ast.If) -> None:
        if ast.unparse(node.test) in ("TYPE_CHECKING", "__name__ == '__main__'"):
            return
        self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if name in ("progress", "say", "step", "print", "quantity", "field", "warn", "leggauss"):
            return
        self.generic_visit(node)

    def visit_Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Constant):  # a docstring
            self.generic_visit(node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        outer = self.scope
        first = node.body[0]
        self.scope = outer if outer != (0, 0) else (first.lineno, node.end_lineno or first.lineno)
        for default in (*node.args.defaults, *node.args.kw_defaults):
            if default is not None:
                self.visit(default)
        for statement in node.body:
            self.visit(statement)
        self.scope = outer

    def visit_Lambda(self, node: ast.Lambda) -> None:
        self.visit(node.body)

    def visit_Assign(self, node: ast.Assign) -> None:
        if self.scope == (0, 0):
            self.name = ast.unparse(node.targets[0])
        if self.name != "__all__":
            self.visit(node.value)
            for target in node.targets:
                self.visit(target)
        self.name = ""

    def visit_AnnAssign(self, node: ast.AnnAssign) -> None:
        if node.value is not None:
            if self.scope == (0, 0):
                self.name = ast.unparse(node.target)
            self.visit(node.value)
            self.name = ""

    def visit_AugAssign(self, node: ast.AugAssign) -> None:
        other = ARITHMETIC.get(type(node.op))
        if other is not None:
            changed = ast.AugAssign(target=node.target, op=other(), value=node.value)
            self._add(node, ast.unparse(changed))
        self.generic_visit(node)

    def _replacements(self, node: ast.AST) -> Iterator[str]:
        if isinstance(node, ast.BinOp):
            yield from self._of_operation(node)
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float, complex):
            yield from _of_number(node.value)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, (ast.USub, ast.Not, ast.Invert)):
            yield f"({ast.unparse(node.operand)})"
        elif isinstance(node, ast.Compare) and len(node.ops) == 1 and type(node.ops[0]) in COMPARISONS:
            flipped = COMPARISONS[type(node.ops[0])]()
            yield _parenthesised(ast.Compare(left=node.left, ops=[flipped], comparators=node.comparators))
        elif isinstance(node, ast.BoolOp):
            other: ast.boolop = ast.Or() if isinstance(node.op, ast.And) else ast.And()
            yield _parenthesised(ast.BoolOp(op=other, values=node.values))
        elif isinstance(node, ast.Call):
            yield from self._of_call(node)
        elif isinstance(node, ast.Attribute) and isinstance(node.ctx, ast.Load) and node.attr in ("real", "imag"):
            yield ast.unparse(ast.Attribute(value=node.value, attr=EXCHANGED[node.attr], ctx=node.ctx))

    def _of_operation(self, node: ast.BinOp) -> Iterator[str]:
        if any(
            isinstance(side, (ast.JoinedStr, ast.List, ast.Tuple, ast.ListComp)) for side in (node.left, node.right)
        ):
            return
        if any(isinstance(side, ast.Constant) and isinstance(side.value, str) for side in (node.left, node.right)):
            return
        if type(node.op) in ARITHMETIC:
            yield _parenthesised(ast.BinOp(left=node.left, op=ARITHMETIC[type(node.op)](), right=node.right))
        if isinstance(node.op, (ast.Add, ast.Sub)):  # a dropped term
            yield _parenthesised(node.left)
            yield _parenthesised(node.right)
        elif isinstance(node.op, (ast.Mult, ast.Div, ast.Pow)):  # a dropped factor
            yield _parenthesised(node.left)
        elif isinstance(node.op, (ast.BitAnd, ast.BitOr)) and self.scope != (0, 0):  # else a union of types
            other: ast.operator = ast.BitOr() if isinstance(node.op, ast.BitAnd) else ast.BitAnd()
            yield _parenthesised(ast.BinOp(left=node.left, op=other, right=node.right))

    @staticmethod
    def _of_call(node: ast.Call) -> Iterator[str]:
        name = getattr(node.func, "attr", getattr(node.func, "id", ""))
        if name in EXCHANGED:
            func = node.func
            if isinstance(func, ast.Attribute):
                changed: ast.expr = ast.Attribute(value=func.value, attr=EXCHANGED[name], ctx=func.ctx)
            else:
                changed = ast.Name(id=EXCHANGED[name], ctx=ast.Load())
            yield ast.unparse(ast.Call(func=changed, args=node.args, keywords=node.keywords))
        if name in DROPPED and len(node.args) == 1 and not node.keywords:
            yield _parenthesised(node.args[0])
        if name in ORDER_MATTERS and len(node.args) >= 2:
            swapped = [*node.args[:-2], node.args[-1], node.args[-2]]
            yield ast.unparse(ast.Call(func=node.func, args=swapped, keywords=node.keywords))

    def _add(self, node: ast.AST, after: str) -> None:
        lineno, end = getattr(node, "lineno", None), getattr(node, "end_lineno", None)
        if lineno is None or end is None:
            return
        start = self._place(lineno, node.col_offset)  # type: ignore[attr-defined]
        stop = self._place(end, node.end_col_offset)  # type: ignore[attr-defined]
        before = self.source[start:stop]
        # Preserve the number of lines.
        after += "\n" * before.count("\n") if before.count("\n") and self._closed(start) else ""
        if after.count("\n") != before.count("\n") or _same(before, after):
            return
        self.found.append(
            Mutant(
                path=self.path, line=self.statement[0], end_line=max(self.statement[1], lineno), start=start, stop=stop,
                before=before, after=after, text=self.lines[lineno - 1].strip(), name=self.name, scope=self.scope,
            )
        )  # fmt: skip

    def _place(self, line: int, column: int) -> int:
        return self.begins[line - 1] + len(self.encoded[line - 1][:column].decode())

    def _closed(self, start: int) -> bool:
        """Return whether a position is inside brackets, where line breaks are permitted."""
        ahead = self.source[self.begins[self.statement[0] - 1] : start]
        ahead = re.sub(r"#[^\n]*|\"[^\"\n]*\"", "", ahead)
        return sum(ahead.count(opening) for opening in "([{") > sum(ahead.count(closing) for closing in ")]}")


def _of_number(value: complex) -> Iterator[str]:
    """Yield changed constants: integers + 1, floats × 1.02, and small floats, which are tolerances, × 1000."""
    if isinstance(value, int):
        yield str(value + 1)
    elif isinstance(value, float):
        factor = 1.02 if abs(value) > TOLERANCES_BELOW else 1000.0
        yield f"{factor * value:.12g}" if value else "1.0"
    else:
        yield f"({1.02 * value})"


def _parenthesised(node: ast.expr) -> str:
    return f"({ast.unparse(node)})"


def _same(before: str, after: str) -> bool:
    try:
        one, other = (ast.dump(ast.parse(text.strip())) for text in (before, after))
    except SyntaxError:
        return False
    return one == other
