"""The README's Python lines run as they are written."""
import re
import textwrap

from conftest import SOURCE


def test_the_readmes_example(monkeypatch, capsys):
    monkeypatch.chdir(SOURCE)
    text = (SOURCE / "README.md").read_text()
    block = re.search(r"\n(    import trilens\n(?:    .*\n)+)", text).group(1)
    names = {}
    exec(textwrap.dedent(block), names)
    assert capsys.readouterr().out.endswith(" pixels\n")
    assert names["depth"].shape == (240, 320)
    assert len(names["where"]) > 0
