#!/usr/bin/env bash
# Snakemake makes a data set in three shards that fill one folder; it is the data set of one command.
# Usage: dataset_shards.sh PROGRAM SOURCE SCRATCH
set -euo pipefail
program=$1 cluster=$2/script/cluster scratch=$3
rm -rf "$scratch"
mkdir -p "$scratch"
cd "$scratch"

cat > 'my plan.toml' <<'END'
scenes = 5
exports = []
[scene]
phantom = { name = "sphere", voxel_mm = 2, radius_mm = { uniform = [15, 25] } }
acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }
render.scan_conversion.slice_size = 64
render.ray_casting = { image_size = 64, steps = 64 }
END

snakemake --quiet all -s "$cluster/Snakefile" --profile "$cluster/local" \
  --config command=dataset 'plan=my plan.toml' shards=3 "out=it's out" "program=$program"
"$program" dataset 'my plan.toml' --out whole > whole.log 2>&1
cmp whole/manifest.jsonl "it's out/manifest.jsonl"
"$program" dataset 'my plan.toml' --out "it's out" --verify 2
