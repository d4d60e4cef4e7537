"""What only program text has, and the lines of a verdict in which it must not be."""

import re
from collections.abc import Iterator

from liepoisson.studies.twisted_top.claims.evidence import Verdict

# Of program text: powers, stars, a hyphen for a minus, numbers with an e, a complex number, ASCII indices and Greek.
PROGRAM_TEXT = re.compile(
    r"\^[\d(]|(?<!T)\*|\b[a-z]' =|(?<![\w.])-\d|\s-\s|\de[+-]\d|\dj\b"
    r"|(?<![A-Za-z])d?(?:l|alpha|beta|[aIJF]_?)\d|\b(?:alpha|beta|epsilon)\b"
)


def lines_of(verdict: Verdict) -> Iterator[str]:
    """All text of the steps."""
    for step in verdict.steps:
        yield from (step.text, *step.computed, *(str(cell) for row in step.table for cell in row))
