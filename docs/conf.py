"""How the documentation is built: ``sphinx-build -W -b html docs docs/_build/html``."""

import re
import sys
from pathlib import Path

from docutils import nodes

sys.path.insert(0, str(Path(__file__).parent))

import rdpm

project = "rdpm"
author = "the rdpm developers"
copyright = "the rdpm developers"
version = release = rdpm.__version__

extensions = [
    "myst_nb",  # Markdown; and pages that are notebooks are run
    "sphinx.ext.autodoc",
    "sphinx.ext.mathjax",
    "sphinx.ext.napoleon",
    "sphinx-mathjax-offline",  # formulas without a network
    "from_the_code",
    "calibration_table",
]
myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 3
nb_execution_mode = "force"
nb_execution_timeout = 300
nb_execution_raise_on_error = True
nb_execution_in_temp = True
exclude_patterns = ["_build"]
smartquotes = False  # -- is the beginning of an option

html_theme = "furo"
html_title = f"rdpm {release}"
html_static_path = ["static"]
html_css_files = ["wide.css"]

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # the docstrings say type, shape, unit and range
autodoc_preserve_defaults = True  # as the source has them, not what they evaluate to
napoleon_google_docstring = False
napoleon_use_rtype = False
napoleon_use_ivar = True


def _plain_references(app, what, name, obj, options, lines):
    """Number the references of a docstring as a list: several share a page, and labels would clash."""
    for n, line in enumerate(lines):
        line = re.sub(r"\[(\d)\]_", r"[\1]", line)
        lines[n] = re.sub(r"^(\s*)\.\. \[(\d)\] ", r"\1\2. ", line)


def _dashes(app, doctree):
    """Set the dash between a parameter and its meaning; two hyphens are left to options."""
    for text in list(doctree.findall(nodes.Text)):
        if text.startswith(" -- "):
            text.parent.replace(text, nodes.Text(f" \N{EN DASH} {text[4:]}"))


def setup(app):
    """Add what is particular to these pages."""
    app.connect("doctree-read", _dashes)
    app.connect("autodoc-process-docstring", _plain_references, priority=400)
