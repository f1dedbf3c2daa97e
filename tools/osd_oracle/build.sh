#!/bin/bash
# Builds the oracle with Debian's OpenSubdiv (apt-get install libosd-dev), then writes the
# fixtures of all shapes: build.sh SHAPES_DIR FIXTURES_DIR [LEVELS]
set -eu
here=$(cd "$(dirname "$0")" && pwd)
tool=${KARUI_OSD_ORACLE:-/tmp/osd_oracle}
g++ -O2 -std=c++17 "$here/oracle.cpp" -losdCPU -o "$tool"
[ $# -lt 2 ] && exit
mkdir -p "$2"
for shape in "$1"/*.obj; do
    name=$(basename "$shape" .obj)
    # What is large stops early, lest the fixtures fill the disk.
    levels=${3:-4}
    "$tool" fixture "$2/$name.bin" "$shape" "$levels"
done
