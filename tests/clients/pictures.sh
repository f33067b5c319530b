#!/bin/sh
# Has a rendered picture read by the libraries of others: tests/clients/pictures.sh SCRIPT.py ARGUMENTS ...
# They go into target/picture-clients; nothing else is touched.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
clients="$here/../../target/picture-clients"
if ! [ -e "$clients/ready" ]; then
    rm -rf "$clients"
    python3 -m venv "$clients"
    "$clients/bin/pip" install --quiet --disable-pip-version-check OpenEXR==3.5.3 numpy==2.4.6 usd-core==26.11
    touch "$clients/ready"
fi
script=$1
shift
exec "$clients/bin/python" -B "$here/$script" "$@"
