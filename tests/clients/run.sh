#!/bin/sh
# Checks files with the libraries of others: tests/clients/run.sh TABLE.exr [SUMS.safetensors [PACKED.exr ...]]
# PACKED are made from TABLE and have beside them, as .json, what `vair table pack --json` said. The libraries go into target/client-venv; nothing else is touched.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
venv="$here/../../target/client-venv"
if ! [ -x "$venv/bin/python" ]; then
    python3 -m venv "$venv"
fi
"$venv/bin/python" -c "import numpy, OpenEXR, safetensors" 2>/dev/null ||
    "$venv/bin/pip" install --quiet --disable-pip-version-check OpenEXR numpy safetensors
python="$venv/bin/python -B"
table=$1
$python "$here/check_table.py" "$table"
if [ $# -gt 1 ]; then
    $python "$here/check_sums.py" "$2"
    shift 2
    for packed in "$@"; do
        $python "$here/check_packed.py" "$packed" "$table" "${packed%.exr}.json"
    done
fi
