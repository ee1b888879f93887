#!/usr/bin/env bash
# The records from which the figures are drawn: two papers at three speeds, as in Penner 1995, Figs. 1 to 4.
# make_records.sh FOLDER [REPLICATES]: FOLDER/thorold-3-1.h5 … baie-comeau-12-5.h5. REPLICATES: 1 to 5, else 5.
# `stickslip` must be in PATH; STICKSLIP_SCENES names the folder of its scenes where it does not find them itself.
set -euo pipefail
folder=$1
replicates=${2:-5}
scenes=()
[ -z "${STICKSLIP_SCENES:-}" ] || scenes=(--folder "$STICKSLIP_SCENES")

# Sheets of one paper differ: S of each replicate by so much from that of the scene.
differences=(0.000 0.002 -0.003 0.003 -0.002)

# sheets NAME SCENE S: the pulls of one paper, two seconds each.
sheets() {
  local name=$1 scene=$2 mu_s=$3 speed replicate sheet
  for speed in 3 6 12; do
    for ((replicate = 1; replicate <= replicates; ++replicate)); do
      sheet=$(awk -v s="$mu_s" -v d="${differences[replicate - 1]}" 'BEGIN {printf "%.3f", s + d}')
      stickslip simulate "$scene" "${scenes[@]}" -o "$folder/$name-$speed-$replicate.h5" \
        --seed "$((100 * speed + replicate))" --set "paper.mu_s=$sheet" \
        --set "effects.constant_speed.pull_speed=$speed in/min" --set "effects.constant_speed.pull=2 s" >/dev/null
    done
  done
}

mkdir -p "$folder"
sheets thorold ring-down-at-12-in-per-min 0.325
sheets baie-comeau stick-slip-at-12-in-per-min 0.35
