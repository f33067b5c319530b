#!/bin/sh
# Vair beside Mitsuba 3 and Cycles, which are fetched from PyPI into target/.
#
#   benches/peers/run.sh agree [OPTIONS]   same scene and hair model in Vair and Mitsuba: are the pictures the same?
#   benches/peers/run.sh race [OPTIONS]    time to equal error: Vair (table, Chiang), Mitsuba, Cycles
#
# Needs Python 3.11 and, for Mitsuba's fast mode, LLVM 19 (Debian: apt-get install libllvm19): 14 does not work, and
# 15 does on processors with AVX-512 only. DRJIT_LIBLLVM_PATH names another.
set -eu
cd "$(dirname "$0")/../.."
what=${1:-agree}
[ $# -eq 0 ] || shift
venv=target/peers-mitsuba
if ! [ -x $venv/bin/python ]; then
    python3 -m venv $venv
    $venv/bin/pip install --quiet --disable-pip-version-check mitsuba==3.9.1 numpy OpenEXR
fi
if [ "$what" = race ] && ! [ -x target/peers-cycles/bin/python ]; then
    python3.11 -m venv target/peers-cycles
    target/peers-cycles/bin/pip install --quiet --disable-pip-version-check bpy==5.0.1
fi
if [ -z "${DRJIT_LIBLLVM_PATH:-}" ]; then
    libraries="/usr/lib/*/libLLVM.so.19* /usr/lib/*/libLLVM-19.so"
    if grep -qs avx512f /proc/cpuinfo; then
        libraries="$libraries /usr/lib/*/libLLVM-15.so"
    fi
    for library in $libraries; do
        if [ -e "$library" ]; then
            export DRJIT_LIBLLVM_PATH="$library"
            break
        fi
    done
    if [ -z "${DRJIT_LIBLLVM_PATH:-}" ]; then
        echo "no LLVM that Mitsuba can use: apt-get install libllvm19, or name a library in DRJIT_LIBLLVM_PATH" >&2
        exit 3
    fi
fi
test -x target/release/vair || cargo build --release
exec $venv/bin/python -B "benches/peers/$what.py" "$@"
