#!/bin/sh
# Checks a table and a picture with Python's OpenEXR: tests/clients/run.sh TABLE.exr [PICTURE.exr]
# The libraries go into target/client-venv; nothing else is touched.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
venv="$here/../../target/client-venv"
if ! [ -x "$venv/bin/python" ]; then
    python3 -m venv "$venv"
fi
"$venv/bin/python" -c "import numpy, OpenEXR" 2>/dev/null ||
    "$venv/bin/pip" install --quiet --disable-pip-version-check OpenEXR numpy
"$venv/bin/python" -B "$here/check_table.py" "$1"
if [ $# -gt 1 ]; then
    "$venv/bin/python" -B "$here/check_picture.py" "$2"
fi
