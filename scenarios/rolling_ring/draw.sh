#!/usr/bin/env bash
# The runs of each figure of Sircar and Patra, a folder each, and how the paper draws them.
#
#     scenarios/rolling_ring/draw.sh PROGRAM FOLDER [FIGURE ...]
set -euo pipefail

(($# >= 2)) || {
  printf 'usage: %s PROGRAM FOLDER [2|3|4|5a|5|6|7|8|9|12b ...]\n' "$0" >&2
  exit 2
}
program=$(realpath "$1")
folder=$2
here=$(dirname "$(realpath "$0")")
shift 2

# curve SCENE NAME [--set PATH=VALUE ...]: one run, in FOLDER/NAME.
curve() {
  local scene=$1 name=$2
  shift 2
  "$program" run "$here/$scene.toml" --force -o "$folder/$name" "$@" >/dev/null
}

# curves SCENE PARAMETER VALUE...: one run for each value, in FOLDER/SCENE_PARAMETER_VALUE.
curves() {
  local scene=$1 parameter=$2 value
  shift 2
  for value in "$@"; do curve "$scene" "${scene}_${parameter}_$value" --set "$parameter=$value"; done
}

# Two panels: ring.centre_of_mass.x over driver.position.x; driver.force.x over
# ring.centre_of_mass.x. All curves in each, and the tip's.
figure_2() {
  curves fig_2 lambda 0 0.001 0.01 0.1 1
  curve fig_2 fig_2_tip --set R=1e-9 --set 'body.ring.hold=["rotation"]'
}

# As Fig. 2, there and back; of the tip, tip.centre_of_mass.x.
figure_3() {
  curves fig_3 lambda 0 0.01 0.1 1
  curve fig_3_tip fig_3_tip
}

# ring.centre_of_mass.x over driver.position.x; inset: around the step near 1.0 (0.9 to 1.1).
figure_4() { curves fig_4 k 34 35 36 37 38; }

# The same.
figure_5a() { curves fig_5a k 38 39 40 41 42; }

# driver.force.x over driver.position.x, a panel each. The paper's F_f has the size of the whole
# force, with driver.force.y, and the sign of its x component.
figure_5() { curves fig_5 lambda 0.01 1 10 100; }

# y over x of the particles from the trajectory, a closed polygon for each of these samples, and the
# centre (ring.centre_of_mass) and the driver (driver.position) as points; a panel each.
#   lambda = 0.01: driver.position.x = 1.215, 1.285, 1.850, 1.915, 2.215 (A to E)
#   lambda = 1: 1.0, 1.2, 1.4, 1.6, 1.8, 2.0
figure_6() { curves fig_6 lambda 0.01 1; }

# driver.force.x over driver.position.x, a panel each; from 10 on it repeats.
figure_7() { curves fig_7 v 0.001 0.01 0.05 0.1; }

# As Fig. 6, a panel each.
#   v = 0.001: driver.position.x = 9.215, 9.285, 9.850, 9.915, 10.215 (A to E)
#   v = 0.01: 9.335, 9.530, 9.970, 10.125, 10.335
#   v = 0.05, 0.1: 9.0, 9.25, 9.5, 9.75, 10.0
figure_8() { curves fig_8 v 0.001 0.01 0.05 0.1; }

# Three rows over driver.position.x, a column for each R: driver.force.x; ring.centre_of_mass.x with a
# dashed line of slope 1; ring.centre_of_mass.y.
figure_9() { curves fig_9 R 0.001 0.01 0.1; }

# driver.force.x over ring.centre_of_mass.x, both curves.
figure_12b() { curves fig_12b v 0.001 0.005; }

(($#)) || set -- 2 3 4 5a 5 6 7 8 9 12b
for figure in "$@"; do "figure_$figure"; done
