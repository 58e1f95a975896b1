from dataclasses import dataclass
@dataclass
class D:
    draw: object
    needs_fields: bool = False
DRAWINGS = {n: D(lambda r, f: []) for n in ["settling-velocity", "trajectory", "relative-position", "gap", "kisses", "contacts", "restitution","convergence","wet-restitution","design-charts"]}
DRAWINGS["videos"] = D(lambda r, f: [], True)
