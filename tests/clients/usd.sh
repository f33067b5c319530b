#!/bin/sh
# Has assets read by the libraries of others: tests/clients/usd.sh SCRIPT.py ARGUMENTS ... | nvidia FILE ...
# They go into target/usd-clients; nothing else is touched.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
clients="$here/../../target/usd-clients"
# Each has a pxr of its own and so a folder of its own: environment NAME, PACKAGES ...
environment() {
    name=$1
    shift
    if ! [ -e "$clients/$name/ready" ]; then
        rm -rf "${clients:?}/$name"
        python3 -m venv "$clients/$name"
        "$clients/$name/bin/pip" install --quiet --disable-pip-version-check "$@"
        touch "$clients/$name/ready"
    fi
}
command=$1
shift
case $command in
nvidia)
    environment usd usd-core==26.11 numpy==2.4.6 usd-validation-nvidia==1.22.0
    for file in "$@"; do
        # Values that repeat could be indexed; readers of fur want them plain. MaterialX's nodes are unknown to
        # this build of USD; check_blender.py holds shaders against one that has them.
        "$clients/usd/bin/nvidia_usd_validate" -D IndexedPrimvarChecker -D UsdShadeShaderSdrCompliance "$file"
    done
    ;;
check_usd.py | write_crates.py)
    environment usd usd-core==26.11 numpy==2.4.6 usd-validation-nvidia==1.22.0
    exec "$clients/usd/bin/python" -B "$here/$command" "$@"
    ;;
check_usdz.py)
    # The last with Pixar's checker of archives for phones.
    environment usdz usd-core==26.5 numpy==2.4.6
    exec "$clients/usdz/bin/python" -B "$here/$command" "$@"
    ;;
check_blender.py | check_blender_vdb.py | check_subdivision.py)
    environment bpy bpy==5.0.1 numpy==1.26.4
    exec "$clients/bpy/bin/python" -B "$here/$command" "$@"
    ;;
*)
    echo "unknown command $command" >&2
    exit 1
    ;;
esac
