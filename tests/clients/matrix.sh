#!/bin/sh
# Has the animals that tests/matrix.rs wrote read by other software: tests/clients/matrix.sh VAIR FOLDER
# Pixar's library and NVIDIA's validator read the assets, OpenVDB the grids, Blender imports the fur, and
# Cycles covers what VAIR's own pictures of the same fur cover. Pictures go into FOLDER.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
vair=$(realpath "$1")
cd "$2"
names=$(cut -d ' ' -f 1 list.txt)
# shellcheck disable=SC2086 # names have no spaces
sh "$here/usd.sh" check_usd.py $names
# shellcheck disable=SC2046
sh "$here/usd.sh" nvidia $(printf '%s.usdc ' $names)
# shellcheck disable=SC2046
sh "$here/vdb.sh" python "$here/check_vdb_values.py" $(printf '%s-grids.vdb ' $names)
checks=
while read -r name arguments; do
    # shellcheck disable=SC2086
    "$vair" --quiet render $arguments --model chiang --no-ground --res 320x240 --spp 32 --mitsuba "$name-scene" -o "$name.exr"
    checks="$checks $name.usdc $name.exr $name-scene/scene.xml $name-cycles.png"
done <list.txt
# shellcheck disable=SC2086
exec sh "$here/usd.sh" check_blender.py $checks
