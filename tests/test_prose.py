"""How documents, docstrings, comments and messages read: turns of phrase that have come in before stay out."""

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parent.parent
FOLDERS = ("python", "crates", "verification", "benchmarks")
TEXTS = [
    *ROOT.glob("*.md"),
    *(ROOT / "docs").rglob("*.md"),
    # not those of the environment that the benchmarks make
    *(path for top in FOLDERS for path in (ROOT / top).rglob("*.py") if ".venv" not in path.parts),
    *(ROOT / "crates").rglob("*.rs"),
]

INSTEAD = {
    r"can not(?! only)": "cannot",
    r"(?<=written )as shortly|as shortly as": "just as short to write",
    r"did not get[.;,]": "did not reach",
    r"files? of ours": "written by liepoisson",
    r"functions? of yours": "a user function",
    r"is left to itself": "keeps running",
    r"that there (?:is|are) not\b(?! )": "unknown, or does not exist",
    r"do(?:es)? not meet it": "almost never hits it",
    r"colours of the house": "colours of the style",
}
"""What to say in place of an expression that is not English, or that only those who wrote it understand."""

LINE = re.compile(r"\s*\n(?:[ \t]*(?://[/!]?|#|\*))?\s*")
"""The end of a line, with what opens a comment on the next."""


def found(text):
    flowing = LINE.sub(" ", text)
    return {match[0]: instead for pattern, instead in INSTEAD.items() for match in re.finditer(pattern, flowing)}


@pytest.mark.parametrize("suffix", [".md", ".py", ".rs"])
def test_texts_say_it_in_plain_english(suffix):
    texts = [path for path in TEXTS if path.suffix == suffix]
    assert len(texts) > 20
    wrong = {str(path.relative_to(ROOT)): found(path.read_text(encoding="utf-8")) for path in texts}
    assert {name: phrases for name, phrases in wrong.items() if phrases} == {}


@pytest.mark.parametrize("text", ["it can\n    not go on", "/// it can\n/// not go on", "# a function\n#   of yours"])
def test_an_expression_is_found_across_lines(text):
    assert len(found(text)) == 1
