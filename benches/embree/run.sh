#!/bin/sh
# The Embree yardsticks: builds the other side in C++ and runs it by turns with Vair.
#
#   benches/embree/run.sh [--quick]                  photons through fibers, photons.cpp
#   benches/embree/run.sh strands [STRANDS] [...]    rays through fur, strands.cpp
#
# Needs a C++ compiler and Embree 4 or 3 with headers, e.g. Debian's libembree-dev. Nothing of the crate
# depends on it. --quick takes three rounds instead of nine; strands takes --species NAME and --rounds N.
set -e
cd "$(dirname "$0")/../.."
what=photons bench=embree
test "$1" = strands && what=strands bench=strands && shift
program=target/embree-$what
mkdir -p target
library=embree3
for folder in /usr/include /usr/local/include ${EMBREE:+"$EMBREE/include"}; do
    test -e "$folder/embree4/rtcore.h" && library=embree4
done
${CXX:-c++} -O3 -march=native -std=c++17 ${EMBREE:+-I"$EMBREE/include" -L"$EMBREE/lib"} \
    -o "$program" "benches/embree/$what.cpp" -l$library -lpthread
exec cargo bench --bench $bench -- "$PWD/$program" "$@"
