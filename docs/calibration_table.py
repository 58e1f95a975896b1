"""The table of the calibration, written by the code that holds it."""

from docutils import nodes
from docutils.parsers.rst import Directive
from docutils.statemachine import StringList

from rdpm.particles.calibration import CALIBRATION

HEADS = ("name", "value", "unit", "meaning", "basis", "command")


class CalibrationTable(Directive):
    """Every fitted or chosen number, one row each."""

    has_content = False

    def run(self):
        """Give the table."""
        rows = [(f"`{name}`", value, unit, meaning, basis, f"`{command}`")
                for name, value, unit, meaning, basis, command in CALIBRATION.rows()]  # fmt: skip
        lines = [HEADS, ["---"] * len(HEADS), *rows]
        text = [f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines]
        holder = nodes.container(classes=["wide"])
        self.state.nested_parse(StringList(text, source="calibration"), 0, holder)
        return [holder]


def setup(app):
    """Make the directive known."""
    app.add_directive("calibration", CalibrationTable)
    return {"parallel_read_safe": True}
