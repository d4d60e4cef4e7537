"""The command `liepoisson lab`: a system in the browser, at an address of this machine or as one file."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from liepoisson.cli.options import SeedOfStartOption, SettingsOption, Where
from liepoisson.cli.output import announce, checked_file
from liepoisson.cli.runs import check_limits
from liepoisson.cli.starts import find_start, seed_of_start
from liepoisson.cli.systems import read_numeric_system
from liepoisson.errors import ParameterError

if TYPE_CHECKING:
    from collections.abc import Sequence

    from liepoisson.laboratory.pages import Page

LAB_HELP = "A name of the catalog or the path of a system file (.toml).  [default: the tops of the laboratory]"
SURFACE_HELP = "A function that is zero on the surface of section: --surface 'dot(l, beta)'.  Repeat it for more."
EXPORT_HELP = "Write the page into this file (.html) instead, which needs nothing else."
WITH_HELP = "A saved orbit or section (.nc), which the page computes again and compares."


def lab(
    system: Annotated[str | None, typer.Argument(help=LAB_HELP, metavar="SYSTEM", show_default=False)] = None,
    *,
    where: Where,
    seed: SeedOfStartOption = None,
    surface: Annotated[list[str] | None, typer.Option(metavar="FORMULA", help=SURFACE_HELP)] = None,
    saved: Annotated[str | None, typer.Option("--with", metavar="FILE", help=WITH_HELP)] = None,
    export: Annotated[str | None, typer.Option(metavar="FILE", help=EXPORT_HELP)] = None,
    no_open: Annotated[bool, typer.Option("--no-open", help="Print the address and open no browser.")] = False,
    settings: SettingsOption = None,
) -> None:
    """Open the laboratory: the moving system with its section, exponents and invariants, computed in the browser.

    The page is served on this machine alone, at an address with a token, until Ctrl-C.
    """
    drawn = seed_of_start(where, seed)
    check_limits(seed=drawn)
    file = None if export is None else checked_file(export, "--export", (".html",), "laboratory.html")
    if file is not None and no_open:
        raise ParameterError("--export and --no-open exclude each other: a file is not opened. Leave --no-open out.")
    page = _page(system, where, drawn, surfaces=surface or (), saved=saved, settings=settings or ())
    if file is not None:
        from liepoisson.laboratory.pages import write_page

        written = write_page(page, file)
        print(f"wrote    {written}")
        return
    _serve(page, opens=not no_open)


def _page(
    name: str | None,
    where: Where,
    seed: int,
    *,
    surfaces: Sequence[str],
    saved: str | None,
    settings: Sequence[str],
) -> Page:
    from liepoisson.laboratory.pages import page_of, page_of_tops

    result: Any = None
    if saved is not None:
        from liepoisson.saved.rerun import load

        result = load(saved)
    if result is not None and where.is_given:
        raise ParameterError("--with and --start, --guess, --leaf, --energy exclude each other: the file has a start.")
    if name is None:
        if result is not None and not settings:
            return page_of(result.system, result=result, surfaces=surfaces)
        if where.is_given or surfaces or settings:
            raise ParameterError(
                "SYSTEM must be given with --start, --leaf, --set and the like. Name one: lab kirchhoff."
            )
        return page_of_tops()
    system = read_numeric_system(name, settings)
    if result is not None:
        return page_of(system, result=result, surfaces=surfaces)
    begin = find_start(system, where, seed)
    return page_of(system, start=begin.state, surfaces=surfaces)


def _serve(page: Page, *, opens: bool) -> None:
    from liepoisson.laboratory.server import serve

    with serve(page) as server:
        try:
            announce(f"{page.words}: {server.url}\nCtrl-C ends it.", ())
            if opens and not _opened(server.url):
                print("No browser could be opened; open this address in one.", file=sys.stderr)
            server.serve_forever()
        except KeyboardInterrupt:
            print()  # after the ^C of the terminal


def _opened(url: str) -> bool:
    """Whether a browser with windows was started; one that runs in the terminal would keep the command waiting."""
    import webbrowser

    try:
        browser = webbrowser.get()
        return type(browser) is not webbrowser.GenericBrowser and browser.open(url)
    except (webbrowser.Error, OSError):
        return False
