#!/bin/bash
# A model simplified to a cage and subdivided back: how far each is from the model.
#   round_trip.sh MODEL SHARE LEVELS [KARUI]
set -eu
model=$1 share=$2 levels=$3 karui=${4:-karui}
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
"$karui" --quiet simplify "$model" --ratio "$share" -o "$work/cage.ply"
"$karui" --quiet subdivide "$work/cage.ply" --scheme loop --levels "$levels" -o "$work/steps.ply"
"$karui" --quiet subdivide "$work/cage.ply" --scheme loop --levels "$levels" --limit -o "$work/limit.ply"
for what in cage steps limit; do
    echo "$what"
    "$karui" --quiet measure "$model" "$work/$what.ply"
done
