#!/usr/bin/env bash
# Draws the figures of Sircar and Patra into FOLDER. Needs matplotlib.
#
#     scenarios/rolling_ring/draw.sh PROGRAM FOLDER [FIGURE ...]
set -euo pipefail

(($# >= 2)) || {
  printf 'usage: %s PROGRAM FOLDER [2|3|4|5a|5|6|7|8|9|12b ...]\n' "$0" >&2
  exit 2
}
here=$(dirname "$(realpath "$0")")
program=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
shift 2
runs=$(mktemp -d)
trap 'rm -r "$runs"' EXIT
cd "$runs"  # curves are named by their folders

# curve SCENE NAME [--set PATH=VALUE ...]: one run, in the folder NAME.
curve() {
  local scene=$1 name=$2
  shift 2
  "$program" run "$here/$scene.toml" --force -o "$name" "$@" >/dev/null
}

# curves SCENE PARAMETER VALUE...: one run for each value, in SCENE_PARAMETER_VALUE.
curves() {
  local scene=$1 parameter=$2 value
  shift 2
  for value in "$@"; do
    curve "$scene" "${scene}_${parameter}_$value" --set "$parameter=$value"
  done
}

# draw PICTURE RUN... [WHAT] [OPTION ...]: as `tomlin plot` takes them.
draw() {
  local picture=$1
  shift
  "$program" plot "$@" -o "$folder/$picture.svg" >/dev/null
}

figure_2() {
  curves fig_2 lambda 0 0.01 0.1 1
  curve fig_3_tip tip_k_2 --set k=2 --set 'run.duration=10 * a / v'
  draw fig_2a fig_2_lambda_{0,0.01,0.1,1} tip_k_2 position --from 0.9 --to 2.4
  draw fig_2b fig_2_lambda_{0,0.01,0.1,1} tip_k_2 hysteresis --from 0.4 --to 2.6
}

figure_3() {
  curves fig_3 lambda 0 0.1 1
  curve fig_3_tip tip
  draw fig_3 fig_3_lambda_{0,0.1,1} tip hysteresis
}

figure_4() {
  curves fig_4 k 34 35 36 37 38
  draw fig_4 fig_4_k_{34,35,36,37,38} position --from 0.97 --to 1.03
}

figure_5a() {
  curves fig_5a k 38 39 40 41 42
  draw fig_5a fig_5a_k_{38,39,40,41,42} position --from 0.97 --to 1.03
}

figure_5() {
  curves fig_5 lambda 0.01 1 10 100
  draw fig_5 fig_5_lambda_{0.01,1,10,100} force_size --from 0 --to 3
}

# At the borders of phases, A to E, that figures.py prints; for lambda = 1, which has none, evenly.
figure_6() {
  curves fig_6 lambda 0.01 1
  draw fig_6a fig_6_lambda_0.01 ring --at 1215,1285,1850,1915,2215
  draw fig_6b fig_6_lambda_1 ring --at 1000,1250,1500,1750,2000
}

figure_7() {
  curves fig_7 v 0.001 0.01 0.05 0.1
  draw fig_7 fig_7_v_{0.001,0.01,0.05,0.1} force --from 10 --to 12
}

# As Fig. 6.
figure_8() {
  curves fig_8 v 0.001 0.01 0.05 0.1
  draw fig_8a fig_8_v_0.001 ring --at 9215,9285,9850,9915,10215
  draw fig_8b fig_8_v_0.01 ring --at 933.5,953,997,1012.5,1033.5
  draw fig_8c fig_8_v_0.05 ring --at 180,185,190,195,200
  draw fig_8d fig_8_v_0.1 ring --at 90,92.5,95,97.5,100
}

figure_9() {
  curves fig_9 R 0.001 0.01 0.1
  draw fig_9 fig_9_R_{0.001,0.01,0.1} --y force_size --y position --y height --from 0 --to 3
}

figure_12b() {
  curves fig_12b v 0.001 0.005
  draw fig_12b fig_12b_v_{0.001,0.005} hysteresis
}

(($#)) || set -- 2 3 4 5a 5 6 7 8 9 12b
for figure in "$@"; do "figure_$figure"; done
