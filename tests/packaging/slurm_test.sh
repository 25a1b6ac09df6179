#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The job scripts for Slurm, without Slurm: a job that is told that its time is up asks to be queued again and goes on
# with the same bits.
# usage: slurm_test.sh BUILD_DIR
set -euo pipefail
build=$1
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/bin"
ln -s "$build/flotilla" "$work/bin/flotilla"
printf '#!/bin/sh\necho "$@" >>"%s/requeued"\n' "$work" >"$work/bin/scontrol"
chmod +x "$work/bin/scontrol"
export PATH=$work/bin:$PATH SLURM_JOB_ID=41 SLURM_CPUS_PER_TASK=1 FLOTILLA_SLURM=$root/scripts/packaging/slurm
fail() { echo "$1"; exit 1; }

# hash FOLDER: of the last step.
hash() { awk -F, 'NR == 1 { for (k = 1; k <= NF; ++k) if ($k == "state_hash") c = k } END { print $c }' "$1/steps.csv"; }

flotilla scene stack --bodies 4 >"$work/scene.json"
flotilla run "$work/scene.json" --steps 100000 --quiet --output "$work/whole" --frame-every 1000 --threads 1 &
whole=$!

# Told to stop as soon as there is a first row of steps.
bash "$FLOTILLA_SLURM/run.sbatch" "$work/scene.json" "$work/run" --steps 100000 --frame-every 1000 --quiet 2>"$work/log" &
job=$!
rows() { wc -l <"$1/steps.csv"; }
until [[ $({ rows "$work/run" || echo 0; } 2>/dev/null) -gt 1 ]]; do sleep 0.05; done
kill -TERM "$job"
code=0
wait "$job" || code=$?
[[ $code == 6 ]] || { cat "$work/log"; fail "exit code $code of a job whose time was up"; }
[[ $(cat "$work/requeued") == "requeue 41" ]] || fail "not queued again"
grep -q '"threads": 1' "$work/run/run.json" || fail "the cores of the allocation were not asked for"
made=$(wc -l <"$work/run/steps.csv")
((made < 100001)) || fail "the job had ended before it was told to"

kill -TERM "$whole"
wait "$whole" || true
steps=$(($(wc -l <"$work/whole/steps.csv") + made))
flotilla run "$work/scene.json" --steps "$steps" --quiet --output "$work/whole" --frame-every 1000 --threads 1 --resume
bash "$FLOTILLA_SLURM/run.sbatch" "$work/scene.json" "$work/run" --steps "$steps" --frame-every 1000 --quiet
[[ $(hash "$work/run") == "$(hash "$work/whole")" ]] || fail "other bits after coming back"
[[ $(wc -l <"$work/requeued") == 1 ]] || fail "a complete job was queued again"

SLURM_ARRAY_JOB_ID=40 SLURM_ARRAY_TASK_ID=7 bash "$FLOTILLA_SLURM/array.sbatch" stack 3 "$work/array" --steps 3 --quiet
[[ $(wc -l <"$work/array/stack-7/steps.csv") == 4 ]] || fail "a task of an array made no run"
