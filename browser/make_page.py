"""Puts the projector's script into its page: make_page.py PAGE SCRIPT OUT"""

import pathlib
import sys

page, script, out = (pathlib.Path(argument) for argument in sys.argv[1:])
mark = "<!-- projector -->"
text, code = page.read_text(), script.read_text()
assert text.count(mark) == 1, f"{page}: {mark} does not stand there once"
assert "</script" not in code, f"{script}: would end the element that it is put into"
part = out.with_name(out.name + ".part")
part.write_text(text.replace(mark, code))
part.replace(out)
