"""Where commands write: results by --out, as a file that can be rerun or as a table, figures by --plot and --figure."""

from __future__ import annotations

import os
import re
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from tempfile import TemporaryFile
from typing import TYPE_CHECKING, Any

from liepoisson.cli.systems import setting_words
from liepoisson.errors import OutputError, ParameterError
from liepoisson.io.files import writing

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from liepoisson.cli.options import Files
    from liepoisson.model.system import System
    from liepoisson.model.vector_field import VectorField

DATA_ENDINGS, TABLE_ENDINGS = (".nc", ".csv"), (".csv",)


_ARGUMENTS: ContextVar[Mapping[str, Sequence[str]] | None] = ContextVar("arguments of the command", default=None)
"""What the command was given, text by text, under the names of its options and arguments."""


@contextmanager
def arguments_are(given: Mapping[str, Sequence[str]]) -> Generator[None]:
    """The block of a command, in which `checked_file` and `figure_stem` compare with all that it was given."""
    token = _ARGUMENTS.set(given)
    try:
        yield
    finally:
        _ARGUMENTS.reset(token)


def file_stem(name: str) -> str:
    """The name of a system as the beginning of file names: what is neither letter nor digit becomes a hyphen.

    It is cut after 100 bytes: file systems take names of 255.
    """
    stem = re.sub(r"\W+", "-", name).encode("utf-8", "replace")[:100].decode("utf-8", "ignore")
    return stem.strip("-") or "system"


def data_file(out: str | None, example: str, endings: Sequence[str] = DATA_ENDINGS) -> Path | None:
    """The path that --out names, refused before the run and not after it."""
    return None if out is None else checked_file(out, "--out", endings, example)


def write_result(result: Any, path: Path) -> Path:
    """Write what a command found: all of it to .nc, or the table with the columns of `to_dataframe()` to .csv."""
    return result.save(path) if path.suffix == ".nc" else result.to_csv(path)


def result_files(
    files: Files, system: System | VectorField, values: Sequence[str], what: str
) -> tuple[Path | None, Path | None]:
    """What the result and the figure of a command are called, as `data_file` and `figure_stem` say.

    Where no name is given it is that of the system, without the values that were set, and `what`: "orbit".
    """
    stem = f"{name_of_files(system, values)}-{what}"
    return data_file(files.out, f"{stem}.nc"), figure_stem(files.plot, files.figure, stem)


def name_of_files(system: System | VectorField, values: Sequence[str]) -> str:
    """How the names of files about a system begin."""
    return file_stem(system.name.removesuffix(setting_words(values)))


def figure_stem(plot: bool, figure: str | None, default: str) -> Path | None:
    """What the figure is called, with an ending unless all formats are wanted; None where none is wanted."""
    if figure is None and not plot:
        return None
    if figure is None:
        _check_folder(path := Path(f"{default}.png"))
        _refuse_taken("--plot", path)
        return path
    from liepoisson.plot.style import FORMATS

    return checked_file(figure, "--figure", ("", *(f".{extension}" for extension in FORMATS)), f"{default}.png")


def checked_file(name: str, option: str, endings: Sequence[str], example: str) -> Path:
    """The path that an option names, refused before the run and not after it; `example` is one that would do."""
    if not name.strip():
        raise ParameterError(f"{option} must name a file; got {name!r}. Write for example {option} {example}.")
    path = Path(name)
    with writing(path):
        is_folder = path.is_dir()
    if is_folder:
        raise OutputError(f"{option} must be a file; {name} is a folder. Write for example {option} {path / example}.")
    if path.suffix not in endings:
        known = ("one of " if len(endings) > 1 else "") + ", ".join(filter(None, endings))
        raise ParameterError(f"{option} must end in {known}; got {name!r:.120}. Write for example {option} {example}.")
    _check_folder(path)
    _refuse_taken(option, path)
    return path


def _refuse_taken(option: str, path: Path) -> None:
    """Refuse to write over a file that another option or argument names, be it read or written."""
    for other, texts in (_ARGUMENTS.get() or {}).items():
        named = [file for text in texts for file in _files(other, Path(text))]
        if other != option and any(_is_one_file(a, b) for a in _files(option, path) for b in named):
            raise ParameterError(
                f"{option} must be another file than {other}, which it would overwrite; got {str(path)!r:.120}. Choose "
                "another name."
            )


def _files(option: str, path: Path) -> list[Path]:
    """The files that an option names: several for a figure without an ending."""
    if option != "--figure" or path.suffix:
        return [path]
    from liepoisson.plot.style import FORMATS

    return [path.with_name(f"{path.name}.{extension}") for extension in FORMATS] if path.name else []


def _is_one_file(a: Path, b: Path) -> bool:
    """Whether two paths lead to one file, which need not exist yet."""
    try:
        return os.path.realpath(a) == os.path.realpath(b) or a.samefile(b)
    except (OSError, ValueError):  # one is not there, or is no path
        return False


def _check_folder(path: Path) -> None:
    """Refuse a folder that nothing can be written to; one that is not there yet is made with the file."""
    with writing(path):
        path.exists()  # fails for a name that is too long
        folder = next((parent for parent in path.absolute().parents if parent.exists()), path.absolute().parent)
        with TemporaryFile(dir=folder):
            pass


def announce(text: str, files: Sequence[Path | None]) -> None:
    """Print what is known before a run; where files are wanted, the run goes on though nobody reads it."""
    try:
        print(text, flush=True)
    except BrokenPipeError:
        if all(path is None for path in files):
            raise


def write_figure(figure: Figure, stem: Path) -> list[Path]:
    """Write a figure in the format that its name ends in, or in all of them."""
    from liepoisson.plot.style import FORMATS, save_figure

    return list(save_figure(figure, stem, formats=(stem.suffix[1:],) if stem.suffix else FORMATS))
