#!/bin/sh
# Makes the virtual environment named by $1 and installs explicable into it, compiled core included.
# PYTHON names the interpreter to use (default: python3).
set -eu
venv=$1
python=${PYTHON:-python3}

# provide WHAT PACKAGE: install the system package if we may, else say in one line what to install.
provide() {
    if [ "$(id -u)" = 0 ] && command -v apt-get >/dev/null 2>&1; then
        echo "installing $2" >&2
        (apt-get update -qq && DEBIAN_FRONTEND=noninteractive apt-get install -y -qq "$2") >/dev/null && return 0
    fi
    echo "explicable needs $1: please install it (Debian, Ubuntu: sudo apt-get install $2)" >&2
    exit 1
}

command -v "$python" >/dev/null 2>&1 || provide "Python 3.11 or newer" python3
"$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || {
    echo "explicable needs Python 3.11 or newer, and $python is $("$python" -V 2>&1): set PYTHON=..." >&2
    exit 1
}
command -v c++ >/dev/null 2>&1 || provide "a C++ compiler" g++
"$python" -c 'import os, sysconfig as s, sys; sys.exit(not os.path.exists(s.get_path("include") + "/Python.h"))' ||
    provide "the Python headers" python3-dev
"$python" -c 'import ensurepip' 2>/dev/null || provide "Python's venv module" python3-venv

"$venv/bin/python" -c 'import pip' 2>/dev/null || { rm -rf "$venv" && "$python" -m venv "$venv"; }
install="$venv/bin/python -m pip install --disable-pip-version-check --quiet --constraint constraints.txt"
$install scikit-build-core nanobind cmake ninja
$install --no-build-isolation --config-settings=build-dir="build/$venv" --editable '.[dev]'
