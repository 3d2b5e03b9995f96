#!/bin/sh
# sh two_widths_test.sh DALEMBERT PROJECT EIGEN WORK
#
# One robot's code for two widths of lanes in one program, not optimised: nothing is inlined then, and what is not static, and does
# not say its width, is linked once and called by both. Exit status: 0 good, 1 the results differ.
set -eu
dalembert=$1 project=$2 eigen=$3 work=$4
rm -rf "$work"
mkdir -p "$work"
cd "$work"
contacts=$(for leg in front_left hind_right; do printf '%s_3_knee: {type: point, at: [0, 0, -0.2]}, ' $leg; done)
for width in 2 8; do
  "$dalembert" generate "$project/tests/robots/quadruped_12.urdf" --base floating --form rolled --forward_dynamics factorization \
    --outputs '[]' --contacts "{$contacts}" --parallel serial --name wide_$width -o wide_$width --functions '{
      free: [forward_dynamics, inverse_mass_matrix], stand: [constrained_forward_dynamics, constrained_forward_dynamics_dq],
      land: [impact], bear: [constrained_inverse_dynamics]}' > told.txt
  c++ -std=c++17 -O0 -DDALEMBERT_LANES=$width -I . -I "$project/runtime/include" -isystem "$eigen" -c wide_$width/dynamics.cpp \
    -o wide_$width.o &
done
c++ -std=c++17 -O0 -I . -I "$project/runtime/include" -isystem "$eigen" -c "$project/tests/packaging/two_widths.cpp" -o main.o
wait
for order in "wide_2.o wide_8.o" "wide_8.o wide_2.o"; do
  # shellcheck disable=SC2086 # two names
  c++ main.o $order -o main
  ./main || { echo "linked as $order"; exit 1; }
done
