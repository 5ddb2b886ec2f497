#!/usr/bin/env bash
# Builds the wheel, installs it into a fresh environment, and tests it there; the add-on under Blender's own module.
set -euo pipefail
cd "$(dirname "$0")"

step() {
    printf '\n== %s\n' "$*"
    "$@"
}

# Packages of the system behind a module that cannot be imported without them.
needs() {
    local module=$1
    shift
    if ! "$env/python" -c "import $module" 2>/dev/null; then
        local as_root
        as_root=$([ "$(id -u)" = 0 ] || echo sudo)
        step $as_root apt-get update
        step $as_root apt-get install -y --no-install-recommends "$@"
    fi
}

# Blender 5.0, the last one as a module for this Python, needs 3.11; the wheel works from 3.10 on.
python=$(command -v python3.11 || command -v python3)
"$python" --version >/dev/null 2>&1 || python=$(command -v python3)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

if ! "$python" -c 'import ensurepip' 2>/dev/null; then
    as_root=$([ "$(id -u)" = 0 ] || echo sudo)
    step $as_root apt-get update
    step $as_root apt-get install -y --no-install-recommends python3-venv
fi
step "$python" -m venv "$work/env"
env=$work/env/bin
step "$env/pip" install --quiet --disable-pip-version-check "maturin>=1.9,<2"
step "$env/maturin" build --release --out "$work/dist"
wheel=$(echo "$work"/dist/*.whl)
step "$env/pip" install --quiet --disable-pip-version-check "$wheel[progress,trimesh,farm,face]" -r tests/requirements.txt
step "$env/pip" uninstall --quiet --yes maturin
needs cv2 libgl1 libglib2.0-0

# The tests see the package that is installed, not the folder of this name.
here=$PWD
cd "$work"
step "$env/python" -m mypy.stubtest mesh_draping._native --ignore-disjoint-bases
step "$env/python" -m mypy --config-file "$here/pyproject.toml" --package mesh_draping
step env PATH="$env:$PATH" "$env/pytest" -q "$here/tests" --basetemp "$work/tests"

if ! "$env/python" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))'; then
    printf '\n== left out, no Python 3.11 here: the add-on under bpy\n'
    exit 0
fi
step "$env/pip" install --quiet --disable-pip-version-check -r "$here/blender/tests/requirements.txt"
needs bpy libegl1 libsm6 libxfixes3 libxi6 libxkbcommon0 libxrender1 libxxf86vm1
# A Blender of its own, without what someone set up on this machine.
export BLENDER_USER_RESOURCES=$work/blender
step "$env/pytest" -q "$here/blender/tests" --basetemp "$work/blender-tests"
