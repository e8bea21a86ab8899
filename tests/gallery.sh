#!/usr/bin/env bash
# Opens a page of the gallery from disk in Chromium: in a window as wide as a desktop's and one as wide as a
# telephone's. SKIPPED where Node, Chromium or playwright-core is not there.
#
#   tests/gallery.sh             a page of some surfaces
#   tests/gallery.sh DIR         the page that is in DIR; pictures of the windows go to DIR/windows
#
# ZEROSET_INSTALL=1 (or CI=true) tries to install what is missing: playwright-core into target/consumers,
# Chromium by apt-get for the superuser. A failure to install is no failure.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

tools="${ZEROSET_TOOLS:-$PWD/target/consumers}"
package=playwright-core@1.65.1
has() { command -v "$1" >/dev/null 2>&1; }
skip() {
    echo "gallery page: SKIPPED: no $1"
    exit 0
}

if [ "${ZEROSET_INSTALL:-}" = 1 ] || [ "${CI:-}" = true ]; then
    mkdir -p "$tools"
    [ -d "$tools/node_modules/playwright-core" ] || ! has npm ||
        timeout 60 npm install --silent --no-fund --no-audit --prefix "$tools" $package || true
    has chromium || [ "$(id -u)" != 0 ] || timeout 300 sh -c "apt-get update -q && \
        DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends chromium" || true
fi
has node || skip Node
has chromium || skip Chromium
NODE_PATH="$tools/node_modules" node -e 'require("playwright-core")' 2>/dev/null || skip playwright-core

folder="${1:-}"
if [ -z "$folder" ]; then
    folder="$(mktemp -d)"
    trap 'rm -rf "$folder"' EXIT
    cargo run --release --locked --quiet -- gallery heart sphere orbital scene1 barth_sextic moebius \
        --page "$folder" --resolution 64 --quiet
fi
NODE_PATH="$tools/node_modules" node tests/consumers/gallery.js "$folder"
