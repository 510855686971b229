"""Sphinx' settings for the pages of docs/; scripts/docs builds them."""
import os
import pathlib
import re

_source = pathlib.Path(os.environ["TRILENS_SOURCE"])
project = "trilens"
author = "The trilens authors"
copyright = author
release = ".".join(re.findall(r"define TRILENS_VERSION_\w+ (\d+)", (_source / "src/base/util/version.h").read_text()))
version = release

extensions = ["myst_parser"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 4
exclude_patterns = ["results/**/*.md"]
# Options keep their two hyphens.
smartquotes = False
# Blocks without a language are commands and formulas.
highlight_language = "none"

html_theme = "furo"
html_title = f"trilens {release}"
html_copy_source = False
html_show_sphinx = False
html_static_path = ["static"]
html_css_files = ["pages.css"]
