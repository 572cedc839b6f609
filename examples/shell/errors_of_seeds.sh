#!/bin/sh
# The error of one scene with several seeds of its speckle and noise, as a table of CSV.
#
#   errors_of_seeds.sh docs/scenes/sphere.toml 1 2 3
set -eu
scene=$1
shift
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
echo "seed,bias_mm,p95_mm,missed_percent"
for seed in "$@"; do
  wobblebench run "$scene" --set "simulation.seed=$seed" --out "$folder" --json 2>"$folder/log" >"$folder/answer.json" ||
    { cat "$folder/log" >&2; exit 1; }
  jq -r --arg seed "$seed" '.error | [$seed, .bias_mm, .p95_mm, .missed_percent] | @csv' "$folder/answer.json"
done
