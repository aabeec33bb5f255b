# SPDX-License-Identifier: CC0-1.0
"""Makes every scene anew in a temporary folder; compares it, byte for byte, with the one in the repository."""

import subprocess
import sys
import tempfile
from pathlib import Path

SCENES = Path(__file__).resolve().parent
SCRIPTS = {
    "cornell.py": "",
    "demo.py": "",
    "furnace.py": "",
    "grey_sphere.py": "",
    "interior.py": "",
    "lights.py": "",
    "shadow.py": "",
    "validation.py": "validation"
}  # script, folder it writes to


def main():
    with tempfile.TemporaryDirectory() as temporary:
        for script, folder in SCRIPTS.items():
            target = Path(temporary) / folder
            target.mkdir(exist_ok=True)
            subprocess.run([sys.executable, SCENES / script, target], check=True)
        made, kept = generated(Path(temporary)), generated(SCENES)
        faults = [f"{name}: made by a script, not in scenes/" for name in sorted(made - kept)]
        faults += [f"{name}: in scenes/, made by no script" for name in sorted(kept - made)]
        faults += [
            f"{name}: differs from what its script makes" for name in sorted(made & kept)
            if (Path(temporary) / name).read_bytes() != (SCENES / name).read_bytes()
        ]
    print("\n".join(faults) or f"{len(made)} scene files are what their scripts make")
    return 1 if faults else 0


def generated(root):
    return {
        path.relative_to(root).as_posix()
        for pattern in ("*.glb", "*.hdr", "*.pfm")
        for path in root.rglob(pattern)
    }


if __name__ == "__main__":
    sys.exit(main())
