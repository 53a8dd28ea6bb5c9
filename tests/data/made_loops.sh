#!/bin/sh
# usage: made_loops.sh PROGRAM DATA: data/make.sh makes the files that are there, byte for byte
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$2/make.sh" "$1" "$folder"
for made in "$folder"/*.csv; do
  cmp "$made" "$2/$(basename "$made")"
done
test "$(find "$folder" -name '*.csv' | wc -l)" -ge 5
