#!/bin/sh
# Makes the virtual environment named by $1 and installs explicable into it, compiled core included.
set -eu
venv=$1
python=${PYTHON:-python3}

need() { # need COMMAND PACKAGE: install the system package if we may, else say in one line what to install
    command -v "$1" >/dev/null 2>&1 && return 0
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
        (apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$2") >/dev/null && return 0
    fi
    echo "explicable needs $1: please install it (Debian, Ubuntu: sudo apt-get install $2)" >&2
    exit 1
}

need "$python" python3
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    echo "explicable needs Python 3.11 or newer, $python is $("$python" -V 2>&1): set PYTHON=..." >&2
    exit 1
}
command -v c++ >/dev/null 2>&1 || need g++ g++

if ! "$venv/bin/python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
    rm -rf "$venv"
    "$python" -m venv "$venv" 2>/dev/null || {
        need ensurepip-missing python3-venv
        "$python" -m venv "$venv"
    }
fi
pip="$venv/bin/python -m pip --disable-pip-version-check"
$pip install --quiet --constraint constraints.txt scikit-build-core nanobind cmake ninja
$pip install --quiet --no-build-isolation --constraint constraints.txt -C build-dir="build/$venv" --editable '.[dev]'
