"""On which line of a TOML text each key stands."""

from __future__ import annotations

import contextlib
import re
import tomllib

from rdpm.config.rule import Path

__all__ = ["line_numbers"]

_SKIP = re.compile(r"(?:[ \t\r\n]|#[^\n]*)*")
_BLANK = re.compile(r"[ \t]*")
_STRING = re.compile(r'"""(?:\\.|[^\\])*?"{3,5}|\'\'\'.*?\'{3,5}|"(?:\\.|[^"\\\n])*"|\'[^\'\n]*\'', re.DOTALL)
_BARE = re.compile(r"[A-Za-z0-9_-]+")
_SCALAR = re.compile(r"[^,\]}#\n]*")


def line_numbers(text: str) -> dict[Path, int]:
    """Map each key path of a TOML text to its line, list items included.

    Parameters
    ----------
    text : str
        TOML that `tomllib` accepts; of other text the map holds as much as was understood.

    Returns
    -------
    dict
        From paths such as ``("bodies", 0, "diameter")`` to lines, counted from 1.

    Examples
    --------
    >>> line_numbers("a = 1\\n[[b]]\\nc = [2,\\n3]")[("b", 0, "c", 1)]
    4
    """
    scan = _Scan(text)
    # what is not understood costs a line in a message, no more
    with contextlib.suppress(IndexError, ValueError, RecursionError):
        scan.document()
    return scan.lines


class _Scan:
    def __init__(self, text: str) -> None:
        self.text, self.at = text, 0
        self.lines: dict[Path, int] = {}
        self._line, self._counted = 1, 0

    def line(self) -> int:
        self._line += self.text.count("\n", self._counted, self.at)
        self._counted = self.at
        return self._line

    def skip(self, pattern: re.Pattern[str] = _SKIP) -> str:
        found = pattern.match(self.text, self.at)
        assert found is not None  # the patterns match nothing as well
        self.at = found.end()
        return self.text[self.at : self.at + 1]

    def note(self, path: Path) -> None:
        self.lines.setdefault(path, self.line())

    def document(self) -> None:
        table: Path = ()
        counts: dict[Path, int] = {}
        while self.skip():
            if self.text[self.at] != "[":
                self.assignment(table)
                continue
            is_array = self.text.startswith("[[", self.at)
            self.at += 1 + is_array
            keys = self.key()
            self.at = self.text.index("]", self.at) + 1 + is_array
            table = ()
            for n, key in enumerate(keys):
                table = (*table, key)
                is_last = n == len(keys) - 1
                if is_last and is_array:
                    counts[table] = counts.get(table, -1) + 1
                if is_last and not is_array:
                    break
                if table in counts:  # a header below an array of tables means its latest item
                    self.note(table)
                    table = (*table, counts[table])
            self.note(table)

    def key(self) -> Path:
        keys: list[str] = []
        while True:
            self.skip(_BLANK)
            found = _STRING.match(self.text, self.at) or _BARE.match(self.text, self.at)
            if found is None:
                raise IndexError
            self.at = found.end()
            word = found[0]
            keys.append(tomllib.loads(f"k={word}")["k"] if word[0] in "\"'" else word)
            if self.skip(_BLANK) != ".":
                return tuple(keys)
            self.at += 1

    def assignment(self, table: Path) -> None:
        path = table
        for key in self.key():
            path = (*path, key)
            self.note(path)
        self.at = self.text.index("=", self.at) + 1
        self.value(path)

    def value(self, path: Path) -> None:
        first = self.skip(_BLANK)
        if first == "[":
            self.at += 1
            n = 0
            while self.skip() != "]":
                self.note((*path, n))
                self.value((*path, n))
                n += 1
                if self.skip() == ",":
                    self.at += 1
            self.at += 1
        elif first == "{":
            self.at += 1
            while self.skip() != "}":
                self.assignment(path)
                if self.skip() == ",":
                    self.at += 1
            self.at += 1
        elif (string := _STRING.match(self.text, self.at)) is not None:
            self.at = string.end()
        else:
            start = self.at
            self.skip(_SCALAR)
            if self.at == start and self.text[self.at] != "\n":
                raise IndexError
