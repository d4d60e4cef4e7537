"""`liepoisson cite`: what to cite in published work."""

import liepoisson as lp


def test_text_and_bibtex_are_those_of_python(command, tmp_path):
    top = lp.Top.twisted_kovalevskaya()
    orbit = lp.integrate(top, lp.sample_states(top, 1, seed=1), t_end=1).save(tmp_path / "orbit.nc")
    file = lp.catalog.path("toda")
    citation = lp.cite(top, "toda")
    assert command("cite", orbit, file) == (0, citation.text + "\n", "")
    assert command("cite", orbit, file, "--format", "bibtex") == (0, citation.bibtex + "\n", "")
    assert command("cite") == (0, lp.cite().text + "\n", "")
