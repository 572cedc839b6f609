#!/usr/bin/env bash
# Snakemake runs a trade in four shards at a time, one of them killed; merged it is the trade of one run, times aside.
# Names have spaces and what a shell would run.
# Usage: four_shards.sh PROGRAM SOURCE SCRATCH
set -euo pipefail
program=$1 cluster=$2/script/cluster scratch=$3
rm -rf "$scratch"
mkdir -p "$scratch"
cd "$scratch"

plan='my plan $(touch was_run).toml' out="it's out"
cat > "$plan" <<'END'
design = "latin_hypercube"
points = 8
seeds = 2
repeats = 1
[scenes.ball]
phantom = { name = "sphere", voxel_mm = 2 }
acquisition = { frames_per_volume = 9, sticks_per_frame = 16 }
render.scan_conversion.slice_size = 64
render.ray_casting.image_size = 64
[axes]
"render.ray_casting.steps" = [32, 64]
"render.ray_casting.iso_level" = { from = 0.5, to = 0.9 }
END

# The first run of shard 2 is killed when it has measured two points.
cat > 'killed once.sh' <<END
#!/usr/bin/env bash
if [[ "\$*" = *"--shard 2/4"* ]] && mkdir was_killed 2>/dev/null; then
  "$program" "\$@" &
  until [ "\$(grep -c '"scene"' "$out/shards/2/points.jsonl" 2>/dev/null)" -ge 2 ] 2>/dev/null; do
    kill -0 \$! || break
    sleep 0.01
  done
  cp "$out/shards/2/points.jsonl" before_the_kill.jsonl
  kill -9 \$! && wait \$!
fi
exec "$program" "\$@"
END
chmod +x "killed once.sh"

snakemake --quiet all -s "$cluster/Snakefile" --profile "$cluster/local" \
  --config "plan=$plan" shards=4 "out=$out" "program=./killed once.sh"
"$program" trade "$plan" --out whole >whole.log 2>&1

[ -d was_killed ] || { echo "shard 2 was not killed"; exit 1; }
[ ! -e was_run ] || { echo "a shell ran what the plan's name holds"; exit 1; }
# What was measured before the kill was not measured again: whole lines stand as they were, times and all.
lines=$(wc -l < before_the_kill.jsonl)
cmp <(head -n "$lines" before_the_kill.jsonl) <(head -n "$lines" "$out/shards/2/points.jsonl")
# The last four columns are times.
cmp <(rev whole/trade.csv | cut -d, -f5- | rev) <(rev "$out/trade.csv" | cut -d, -f5- | rev)
