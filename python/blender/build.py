"""Builds the extension: `python build.py OUT.zip WHEEL...` puts the add-on and the wheels of mesh_draping into one file.

One wheel for each platform that the file shall install on; Blender takes the one that fits.
"""

import sys
import zipfile
from pathlib import Path

ADDON = Path(__file__).parent / "mesh_draping_addon"
MANIFEST = "blender_manifest.toml"
NO_WHEELS = "wheels = []"
#: Files have no date, so that the same inputs give the same bytes.
LONG_AGO = (1980, 1, 1, 0, 0, 0)


def build(output: Path, wheels: "list[Path]") -> None:
    """Writes the extension."""
    listed = ", ".join(f'"./wheels/{wheel.name}"' for wheel in wheels)
    manifest = (ADDON / MANIFEST).read_text()
    if NO_WHEELS not in manifest:
        raise SystemExit(f"{MANIFEST}: lacks the line '{NO_WHEELS}'")
    files = {MANIFEST: manifest.replace(NO_WHEELS, f"wheels = [{listed}]").encode()}
    files |= {path.name: path.read_bytes() for path in sorted(ADDON.glob("*.py"))}
    files |= {f"wheels/{wheel.name}": wheel.read_bytes() for wheel in wheels}
    with zipfile.ZipFile(output, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(zipfile.ZipInfo(name, LONG_AGO), content, zipfile.ZIP_DEFLATED)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        raise SystemExit(__doc__)
    build(Path(sys.argv[1]), [Path(name) for name in sys.argv[2:]])
