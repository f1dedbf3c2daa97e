#!/usr/bin/env bash
# Seeds for the readers: fuzz/seeds.sh FOLDER [LARGEST_BYTES]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
target=$1 largest=${2:-40000} models=${KARUI_MODELS:-../shared/models}

gather() {
    local folder=$target/read_$1 file n=0
    shift
    mkdir -p "$folder"
    while IFS= read -r file; do
        cp "$file" "$folder/$n-$(basename "$file")"
        n=$((n + 1))
    done < <(find -L "$models" -type f -size "-${largest}c" \( "$@" \) | sort)
    echo "$n seeds in $folder"
}

gather obj -iname '*.obj'
gather ply -iname '*.ply'
gather stl -iname '*.stl'
gather off -iname '*.off'
gather gltf -iname '*.gltf' -o -iname '*.glb'
mkdir -p "$target/read_gz"
for file in "$target"/read_off/*; do
    gzip -nc "$file" >"$target/read_gz/$(basename "$file").gz"
done
# The first byte says the format.
mkdir -p "$target/slices"
for kind in 0:ply 1:stl 2:obj 3:gltf 4:gltf; do
    for file in "$target/read_${kind#*:}"/*; do
        { printf "\\x0${kind%:*}" && cat "$file"; } >"$target/slices/${kind%:*}-$(basename "$file")"
    done
done
echo "$(find "$target/slices" -type f | wc -l) seeds in $target/slices"
mkdir -p "$target/decode_image"
find -L "$models" -type f -size "-${largest}c" \( -iname '*.png' -o -iname '*.jpg' \) \
    -exec cp {} "$target/decode_image" \;
echo "$(find "$target/decode_image" -type f | wc -l) seeds in $target/decode_image"
echo "$(find "$target/read_gz" -type f | wc -l) seeds in $target/read_gz"
