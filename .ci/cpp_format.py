"""Refuse C++ that clang-format would change."""

import subprocess
import sys
from pathlib import Path

root = Path(__file__).resolve().parents[1]
files = sorted(str(path) for pattern in ("*.hpp", "*.cpp") for path in (root / "cpp").rglob(pattern))
sys.exit(subprocess.run(["clang-format", "--dry-run", "--Werror", *files], check=False).returncode)
