"""The laboratory: any system in a browser, computed there by the same core.

`page_of` makes the page of a system as one text, `write_page` one self-contained file, `serve` shows it at an address
of this machine alone.
"""

from liepoisson.laboratory.pages import Page, page_of, page_of_tops, write_page
from liepoisson.laboratory.server import PageServer, serve

__all__ = ["Page", "PageServer", "page_of", "page_of_tops", "serve", "write_page"]
