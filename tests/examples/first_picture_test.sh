#!/usr/bin/env bash
# first_picture_test.sh FIRST TRILENS SCENES FOLDER: the small program of the first picture draws the command's bytes, and
# refuses what the command refuses.
set -euo pipefail
first=$1 trilens=$2 scenes=$3 folder=$4

rm -rf "$folder"
mkdir -p "$folder"
for scene in flat context; do
    "$first" "$scenes/$scene.json" "$folder/$scene.png" 2>/dev/null
    "$trilens" render "$scenes/$scene.json" -o "$folder/$scene-command.png" -q
    cmp "$folder/$scene.png" "$folder/$scene-command.png"
done
for wrong in "$scenes/nowhere.json" "$0"; do
    status=0
    "$first" "$wrong" "$folder/none.png" 2>/dev/null || status=$?
    if ((status != 3)) || [[ -e $folder/none.png ]]; then
        echo "$wrong: ends with $status" >&2
        exit 1
    fi
done
echo "the same pictures"
