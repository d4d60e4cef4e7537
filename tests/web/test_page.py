"""The page of the laboratory, as it is shipped: one small file, made from these sources, that asks for nothing."""

import importlib.util
import json
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
MOST = 1_700_000
"""Bytes of the page."""


@pytest.fixture(scope="module")
def build():
    spec = importlib.util.spec_from_file_location("build_page", ROOT / "web" / "build_page.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_page_is_made_from_these_sources(build):
    record = json.loads(build.RECORD.read_text(encoding="utf-8"))
    assert record["page"] == build.hash_of(build.PAGE)
    assert record["sources"] == build.hash_of_sources(), (
        "the page was changed since it was built; `make page` builds it"
    )


def test_the_page_is_small_and_needs_no_other_file(build):
    text = build.PAGE.read_text(encoding="utf-8")
    assert build.PAGE.stat().st_size < MOST
    markup = re.sub(r"(<script[^>]*>).*?(?=</script>)", r"\1", text, flags=re.DOTALL)
    assert not re.search(r"<(script|link|img|iframe)[^>]*\b(src|href)=\"(?!data:)[^\"]", markup)
    assert "url(http" not in text


def test_the_policy_of_the_page_lets_nothing_in_or_out(build):
    text = build.PAGE.read_text(encoding="utf-8")
    found = re.search(r'http-equiv="Content-Security-Policy" content="([^"]*)"', text)
    assert found is not None
    policy = dict(part.strip().split(" ", 1) for part in found[1].split(";"))
    assert (policy["default-src"], policy["connect-src"]) == ("'none'", "'none'")
    assert re.fullmatch(r"'sha256-[A-Za-z0-9+/=]{44}' 'wasm-unsafe-eval'", policy["script-src"])
