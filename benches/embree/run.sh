#!/bin/sh
# The Embree yardstick: builds the loop of photons.cpp and runs it by turns with Vair.
#
# Needs a C++ compiler and Embree 4 or 3 with headers, e.g. Debian's libembree-dev. Nothing of the crate
# depends on it. `benches/embree/run.sh --quick` takes three rounds instead of nine.
set -e
cd "$(dirname "$0")/../.."
program=target/embree-photons
mkdir -p target
library=embree3
for folder in /usr/include /usr/local/include ${EMBREE:+"$EMBREE/include"}; do
    test -e "$folder/embree4/rtcore.h" && library=embree4
done
${CXX:-c++} -O3 -march=native -std=c++17 ${EMBREE:+-I"$EMBREE/include" -L"$EMBREE/lib"} \
    -o "$program" benches/embree/photons.cpp -l$library
exec cargo bench --bench embree -- "$PWD/$program" "$@"
