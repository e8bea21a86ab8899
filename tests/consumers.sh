#!/usr/bin/env bash
# Opens files of every kind with programs that others wrote. Those that are not there are SKIPPED; those
# that are must find no fault. A table says what was opened; the exit code is 1 if anything was wrong.
#
#   tests/consumers.sh           the light ones, in two minutes at most
#   tests/consumers.sh --full    Blender (bpy) and MeshLab (pymeshlab) as well
#
# ZEROSET_INSTALL=1 (or CI=true) tries to install what is missing: Python and Node packages into
# target/consumers, others by apt-get for the superuser. A failure to install is no failure.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

python_packages="numpy==2.4.6 trimesh==5.2.0 networkx==3.6.1 lxml==6.1.3 manifold3d==3.5.4 lib3mf==2.5.0 \
openimageio==3.2.2.0"
full_packages="bpy==5.0.1 pymeshlab==2025.7.post1"
node_packages="gltf-validator@2.0.0-dev.3.10"
debian_packages="assimp-utils openexr pngcheck"

is_full=false
[ "${1:-}" = --full ] && is_full=true
tools="${ZEROSET_TOOLS:-$PWD/target/consumers}"
helpers=tests/consumers
files="$(mktemp -d)"
trap 'rm -rf "$files"' EXIT
table="$files/table"
: >"$table"

has() { command -v "$1" >/dev/null 2>&1; }

# An environment of its own for each list: Blender wants an older numpy.
install_python() { # folder seconds packages...
    local folder="$1" seconds="$2"
    shift 2
    [ "$(cat "$folder/packages" 2>/dev/null)" = "$*" ] && return
    python3 -m venv "$folder" && timeout "$seconds" "$folder/bin/pip" install -q "$@" &&
        echo "$*" >"$folder/packages"
}

install_node() {
    [ -d "$tools/node_modules/gltf-validator" ] ||
        timeout 60 npm install --silent --no-fund --no-audit --prefix "$tools" "$@"
}

install_debian() {
    has assimp && has exrmaketiled && has pngcheck && return
    [ "$(id -u)" = 0 ] && timeout 80 sh -c "apt-get update -q && DEBIAN_FRONTEND=noninteractive \
        apt-get install -q -y --no-install-recommends $*"
}

if [ "${ZEROSET_INSTALL:-}" = 1 ] || [ "${CI:-}" = true ]; then
    mkdir -p "$tools"
    # shellcheck disable=SC2086 # lists of words
    {
        install_python "$tools/light" 90 $python_packages >"$tools/python.log" 2>&1 &
        install_node $node_packages >"$tools/node.log" 2>&1 &
        install_debian $debian_packages >"$tools/debian.log" 2>&1 &
        if $is_full; then
            install_python "$tools/full" 1800 $full_packages >"$tools/full.log" 2>&1 &
        fi
    }
    wait || true
fi

export PATH="$tools/light/bin:$PATH"
# Nothing is left in the sources.
export PYTHONDONTWRITEBYTECODE=1

# The first Python that can import the modules.
python_with() {
    local python module
    for python in "$tools/light/bin/python" "$tools/full/bin/python" python3; do
        for module in "$@"; do
            "$python" -c "import $module" >/dev/null 2>&1 || continue 2
        done
        echo "$python"
        return
    done
    return 1
}

row() { printf '%s\t%s\t%s\n' "$1" "$2" "$3" >>"$table"; }
skip() { row "$1" - "SKIPPED: not here"; }

# A helper prints rows; one that stops on the way is a fault as well.
helper() { # tool command...
    local tool="$1"
    shift
    "$@" >>"$table" 2>"$files/errors" || row "$tool" - "FAULT: $(tail -n 1 "$files/errors")"
}

# A program that takes one file: a fault if it fails, or says something that the pattern is in.
inspect() { # tool file pattern command...
    local tool="$1" file="$2" pattern="$3" said
    shift 3
    if ! said="$("$@" 2>&1)" || grep -qiE "$pattern" <<<"$said"; then
        row "$tool" "$(basename "$file")" \
            "FAULT: $( (grep -iE "$pattern" <<<"$said" || tail -n 1 <<<"$said") | head -n 1)"
    else
        row "$tool" "$(basename "$file")" ok
    fi
}

cargo run --release --locked --quiet --example meshes -- "$files"
for layers in true false; do
    cat >"$files/layers_$layers.toml" <<TOML
version = 1
[[surface]]
name = "Würfel"
f = "x^4 + y^4 + z^4 = 0.4"
[voxels]
resolution = 64
[image]
width = 96
height = 64
background = "transparent"
[output]
png = true
exr = true
layers = $layers
ply = true
TOML
done
cat >"$files/film.toml" <<TOML
version = 1
[params]
a = 0.5
[[surface]]
f = "x^2 + y^2 + z^2 = a"
[voxels]
resolution = 32
[image]
width = 32
height = 32
[animation]
frames = 3
[animation.params]
a = [0.5, 1]
[output]
apng = true
png = true
TOML
cargo run --release --locked --quiet -- --quiet --out "$files" "$files"/*.toml

if has node && NODE_PATH="$tools/node_modules" node -e 'require("gltf-validator")' 2>/dev/null; then
    helper "Khronos validator" env NODE_PATH="$tools/node_modules" node $helpers/gltf.js "$files"
else
    skip "Khronos validator"
fi
for module in trimesh manifold3d; do
    if python="$(python_with trimesh $module)"; then
        helper $module "$python" $helpers/meshes.py $module "$files"
    else
        skip $module
    fi
done
if python="$(python_with lib3mf)"; then
    helper lib3mf "$python" $helpers/lib3mf_check.py "$files"
else
    skip lib3mf
fi
if has assimp && has python3; then
    helper assimp python3 $helpers/assimp.py "$files"
else
    skip assimp
fi
for program in oiiotool exrmaketiled pngcheck; do
    has $program || skip $program
done
for file in "$files"/*.exr; do
    has oiiotool && inspect oiiotool "$file" "error|warning" oiiotool --info -v --stats "$file"
    has exrmaketiled && inspect exrmaketiled "$file" "error|cannot" exrmaketiled "$file" "$files/tiled"
done
for file in "$files"/*.png "$files"/*.apng; do
    has oiiotool && inspect oiiotool "$file" "error|warning" oiiotool --info -v --stats "$file"
    has pngcheck && inspect pngcheck "$file" "error|warning" pngcheck "$file"
done
if $is_full; then
    for program in bpy:blender_check.py pymeshlab:meshlab_check.py; do
        module="${program%:*}"
        if python="$(python_with "$module")"; then
            helper "$module" "$python" "$helpers/${program#*:}" "$files"
        else
            skip "$module"
        fi
    done
fi

column -t -s "$(printf '\t')" "$table" 2>/dev/null || cat "$table"
if grep -q "	FAULT" "$table"; then
    exit 1
fi
