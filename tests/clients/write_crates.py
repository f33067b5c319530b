"""Pixar's library writes a layer as crate files of other versions: write_crates.py FILE.usda FOLDER

Each is FOLDER/VERSION.usdc; its arrays are packed as that version does, which this program's writer never does.
"""

import os
import subprocess
import sys
from pathlib import Path

source, folder = sys.argv[1:]
Path(folder).mkdir(parents=True, exist_ok=True)
script = "import sys; from pxr import Sdf; sys.exit(not Sdf.Layer.FindOrOpen(sys.argv[1]).Export(sys.argv[2]))"
for version in ["0.4.0", "0.5.0", "0.6.0", "0.7.0", "0.8.0", "0.9.0", "0.10.0", "0.12.0"]:
    path = Path(folder) / f"{version}.usdc"
    environment = os.environ | {"USD_WRITE_NEW_USDC_FILES_AS_VERSION": version}
    subprocess.run([sys.executable, "-c", script, source, str(path)], env=environment, check=True)
    written = ".".join(str(number) for number in path.read_bytes()[8:11])
    if written != version:
        sys.exit(f"FAIL {path} has version {written}")
print(f"OK {folder}")
