#!/usr/bin/env bash
# compare.sh BASE_PROGRAM NEW_PROGRAM FOLDER: whether a change made the picture worse, slower, or cost more fetches.
# Exit code 1: a limit is broken. FOLDER/checks.xml is for the service's list of tests, FOLDER/compare.md for the
# merge request, FOLDER/report.html for people.
set -euo pipefail
base=$1 new=$2 folder=$3
"$new" compare "$base" "$new" --seeds "${SEEDS:-5}" --set render.ray_casting.image_size="${IMAGE_SIZE:-256}" \
  ${LIMITS:+--limits "$LIMITS"} --out "$folder" --junit "$folder.xml"
