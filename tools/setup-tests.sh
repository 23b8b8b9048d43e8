#!/bin/sh
# Installs what `cargo test` needs beyond Rust, on Debian or Ubuntu: TetGen and GetDP as packages, and the Python readers and
# solvers that check gsm's files in an environment of their own, target/clients. Quick when everything is there.
set -eu
cd "$(dirname "$0")/.."

as_root() {
    if [ "$(id -u)" -eq 0 ]; then "$@"; else sudo "$@"; fi
}

# Packages by the program that each must yield; python3-venv is judged by what it makes possible.
missing=""
command -v tetgen >/dev/null || missing="$missing tetgen"
command -v getdp >/dev/null || missing="$missing getdp"
command -v python3 >/dev/null || missing="$missing python3"
python3 -c 'import ensurepip, venv' 2>/dev/null || missing="$missing python3-venv"
# Shared libraries that the wheel of Gmsh loads.
for library in libGLU.so.1 libXft.so.2 libXrender.so.1 libXcursor.so.1 libXfixes.so.3 libXinerama.so.1; do
    if ! ldconfig -p 2>/dev/null | grep -q "$library"; then
        missing="$missing libglu1-mesa libxft2 libxrender1 libxcursor1 libxfixes3 libxinerama1"
        break
    fi
done
if [ -n "$missing" ]; then
    as_root apt-get update -q
    # shellcheck disable=SC2086 # a list of words
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $missing
fi

clients=target/clients
[ -x "$clients/bin/python" ] || python3 -m venv "$clients"
if ! "$clients/bin/python" -c 'import gmsh, meshio, ngsolve, numpy, scipy, trimesh' 2>/dev/null; then
    "$clients/bin/python" -m pip install -q --disable-pip-version-check --prefer-binary \
        'gmsh==4.15.*' 'meshio==5.3.*' 'ngsolve==6.2.2608' numpy scipy trimesh
fi
"$clients/bin/python" -c 'import gmsh, meshio, ngsolve, numpy, scipy, trimesh'
