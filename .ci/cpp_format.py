"""Refuse C++ that clang-format would change."""

import shutil
import subprocess
import sys
from pathlib import Path

root = Path(__file__).resolve().parents[1]
files = sorted(str(path) for pattern in ("*.hpp", "*.cpp") for path in (root / "cpp").rglob(pattern))
# The one of this environment, activated or not.
program = shutil.which("clang-format", path=str(Path(sys.executable).parent)) or "clang-format"
sys.exit(subprocess.run([program, "--dry-run", "--Werror", *files], check=False).returncode)
