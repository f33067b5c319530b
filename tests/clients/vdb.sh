#!/bin/sh
# Has OpenVDB files read by OpenVDB itself: tests/clients/vdb.sh python SCRIPT ARGUMENTS ... | print FILE
# The library (10.0, Debian's packages) is unpacked into target/openvdb; nothing is installed. Needs apt
# with its lists, or the packages on the system.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root="$here/../../target/openvdb"
if ! [ -e "$root/ready" ]; then
    rm -rf "$root"
    mkdir -p "$root/debs"
    root=$(cd "$root" && pwd)
    cd "$root/debs"
    # All that apt would have to install, which differs from machine to machine.
    links() {
        apt-get install --print-uris --yes --no-install-recommends libopenvdb-tools python3-openvdb 2>/dev/null |
            sed -n "s/^'\([^']*\)'.*/\1/p"
    }
    [ -n "$(links)" ] || dpkg -s python3-openvdb >/dev/null 2>&1 || apt-get update >/dev/null
    for link in $(links); do
        curl --silent --show-error --fail --location --remote-name "$link"
    done
    for package in *.deb; do
        [ -e "$package" ] && dpkg -x "$package" "$root"
    done
    cd - >/dev/null
    rm -r "$root/debs"
    touch "$root/ready"
fi
root=$(cd "$root" && pwd)
lib="$root/usr/lib/x86_64-linux-gnu"
export LD_LIBRARY_PATH="$lib:$lib/blas:$lib/lapack:${LD_LIBRARY_PATH:-}"
export PYTHONPATH="$root/usr/lib/python3/dist-packages" PYTHONDONTWRITEBYTECODE=1
command=$1
shift
case $command in
python) exec /usr/bin/python3 "$@" ;;
print) PATH="$root/usr/bin:$PATH" exec vdb_print "$@" ;;
*)
    echo "unknown command $command" >&2
    exit 1
    ;;
esac
