"""The laboratory: any system in a browser, computed there by the same core.

`page_of` makes the page of a system as one text, `write_page` one self-contained file, `serve` shows it at an address
of this machine alone, and `view` in a cell of a notebook.
"""

from liepoisson._lazy import attach

__getattr__, __dir__, __all__ = attach(__name__, __file__)
