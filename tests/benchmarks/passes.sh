#!/bin/sh
# sh tests/benchmarks/passes.sh [URDF [OPTION of generate...]]   What every pass and form is worth: M and C with one left out at a
# time. Prints a Markdown table: operations of the scalar program, bytes of code and constants, seconds to compile, and
# nanoseconds of processor time per evaluation (median of 15 repetitions and their deviation). Needs build/release/bin/dalembert.
set -eu
cd "$(dirname "$0")/../.."
urdf=${1:-examples/mahru/mahru.urdf}
[ $# -eq 0 ] || shift
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
flags="-std=c++17 -O3 -march=native -Iruntime/include -isystem /usr/include/eigen3"
machine=$(build/release/bin/dalembert --machine | head -n 1)
printf '%s, %s, %s, load average %s, %s\n\n' "$machine" "$(date +%F)" "$(${CXX:-g++} --version | head -n 1)" \
  "$(cut -d ' ' -f 1 /proc/loadavg)" "$(basename "$urdf")"
echo '| variant | operations | code and constants, bytes | compile, s | ns |'
echo '|---|---:|---:|---:|---:|'

measure() {  # title, options...
  title=$1
  shift
  rm -rf "$work/robot"
  build/release/bin/dalembert generate "$urdf" -o "$work/robot" --name robot --outputs mass_matrix,coriolis_matrix --parallel serial "$@" \
    2>/dev/null >"$work/log" || { cat "$work/log"; exit 1; }
  operations=$(sed -n 's|^// all together *||p' "$work/robot/dynamics.hpp" | awk '{ if (NF > 4) print $2 + $4 + $8; else print $1 + $2 + $4 }')
  start=$(date +%s.%N)
  ${CXX:-g++} $flags -c "$work/robot/dynamics.cpp" -o "$work/dynamics.o"
  seconds=$(echo "$(date +%s.%N) $start" | awk '{ printf "%.1f", $1 - $2 }')
  ${CXX:-g++} $flags -DROBOT=robot -I"$work/robot" tests/benchmarks/one_robot.cpp "$work/dynamics.o" -lbenchmark -lpthread -o "$work/time"
  times=$("$work/time" --benchmark_repetitions=15 --benchmark_min_time=0.05 --benchmark_report_aggregates_only=true \
    --benchmark_format=csv 2>/dev/null | awk -F, '/_median/ { m = $4 } /_stddev/ { s = $4 } END { printf "%.0f ± %.0f", m, s }')
  echo "| $title | $operations | $(size "$work/dynamics.o" | awk 'NR == 2 { print $1 }') | $seconds | $times |"
}

for form in rolled straight; do
  measure "$form" --form $form "$@"
  for pass in fold share move_parameters; do
    measure "$form, without $pass" --form $form --without $pass "$@"
  done
done
measure 'rolled, without pack (limbs one after another)' --form rolled --without pack "$@"
