#!/usr/bin/env bash
# Measure the arena anew: docs/arena/measure.sh FOLDER writes a record of each row to FOLDER.
#
# Newton, CalculiX and NairnMPM must be installed or named: see docs/arena.md, which also says what is not run.
# It takes about ninety minutes of one core.
set -euo pipefail
exec </dev/null

records=$(mkdir -p "$1" && cd "$1" && pwd)
cd "$(dirname "${BASH_SOURCE[0]}")/scenes"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
classical="bardenhagen,bardenhagen(criterion=position,normal=master)"
nairn="nairn,nairn(normals=LOGR,shape=lCPDI)"

# A code that cannot run a scene is refused, and leaves a record with the reason
all="newton,calculix,$nairn"

# SCENE CODES [OPTIONS]
measure() {
  local scene=$1 codes=$2
  shift 2
  mpmfw compare "$scene" --contact "penalty,lcp,$classical" --code "$codes" --records "$records" \
    -o "$work/arena.nc" --force "$@" > "$work/table.txt" 2>> "$work/notes.txt"
}

for kind in slip no-slip; do
  measure "rolling-cylinder-$kind-rigid" "$all" --vary grid.cell_size=0.8,0.4
  measure "rolling-cylinder-$kind-rigid" "$nairn" --set grid.cell_size=0.2
  measure "rolling-cylinder-$kind" "$all"
  measure "./cylinder-$kind-turned.toml" "$all"
  measure "rolling-sphere-$kind-rigid" "$all"
done
for scene in block-rigid stopping-block belt colliding-discs colliding-discs-level hertz-impact; do
  measure "./$scene.toml" "$all"
done
measure sliding-block "$all"
measure footing "$all" --set grid.cell_size=0.25
measure wheel "$all"
measure taylor-bar "$all"
measure colliding-rings "$all"
