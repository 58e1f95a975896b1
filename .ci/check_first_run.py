"""What the README's first command must have left behind: a complete folder, and a pair that kissed and tumbled."""

import json
import sys
from pathlib import Path

folder = Path("dkt")
expected = [
    *("case.toml", "summary.json", "particles.csv", "contacts.csv", "history.csv", "timing.csv", "run.log"),
    *("fields.vtkhdf", "bodies.vtkhdf", "report.html", "video.mp4", "figures/settling_velocity.png"),
    *("figures/trajectory.png", "figures/gap.png", "figures/flow.png"),
]
may_be_empty = {"run.log"}
missing = [
    name
    for name in expected
    if not (folder / name).is_file() or ((folder / name).stat().st_size == 0 and name not in may_be_empty)
]
summary = json.loads((folder / "summary.json").read_text())
pair = summary["dkt"]
print({key: summary[key] for key in ("status", "steps", "dt_s", "wall_s", "ns_per_cell_step", "dkt")})
kissed, tumbled = pair["kiss_time_s"], pair["tumble_time_s"]
problems = [f"missing or empty: {missing}"] if missing else []
if summary["status"] != "done":
    problems.append(f"status {summary['status']}")
# Bands around what other steps, marker placings and films gave (docs/validation.md); tumbling is an instability.
if kissed is None or not 1.42 <= kissed <= 1.48:
    problems.append(f"kiss at {kissed} s, expected from 1.42 to 1.48")
if tumbled is None or not 2.5 <= tumbled <= 2.8:
    problems.append(f"tumble at {tumbled} s, expected from 2.5 to 2.8")
sys.exit("\n".join(problems) or 0)
