#!/usr/bin/env bash
# Prints where the samples of a skull are, for `ZEROSET_CRANIUM`: `matrix.dat` of Debian's package
# invesalius-examples, 19 MB, fetched into target/cranium. Where it cannot be had nothing is printed, and
# that is no failure: the test says SKIPPED.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder="$PWD/target/cranium"
if [ ! -s "$folder/matrix.dat" ]; then
    mkdir -p "$folder"
    (
        cd "$folder"
        timeout 60 apt-get download invesalius-examples
        dpkg -x invesalius-examples_*.deb package
        tar -xzf "$(find package -name Cranium.inv3)" --strip-components=1 --wildcards '*/matrix.dat'
        rm -r package invesalius-examples_*.deb
    ) >"$folder/log" 2>&1 || exit 0
fi
echo "$folder/matrix.dat"
