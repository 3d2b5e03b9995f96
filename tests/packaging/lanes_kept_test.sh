#!/bin/sh
# sh lanes_kept_test.sh PROJECT
#
# Compilers differ in which vectors an empty asm may hold in a register (keep_in_register() of dalembert/lanes.hpp): every width of
# lanes, float and double, with and without the machine's own registers. Exit status: 0 good, 1 one does not compile, 77 there is
# no clang++ to ask.
set -eu
failed=0
for compiler in c++ clang++; do
  command -v "$compiler" > /dev/null || { echo "SKIPPED: no $compiler on this machine"; exit 77; }
  for lanes in 1 2 4 8; do
    for flags in "" "-march=native"; do
      # shellcheck disable=SC2086 # none is an argument less
      "$compiler" -std=c++17 -O1 -Wall -Wextra -Werror -Wno-psabi $flags -DDALEMBERT_LANES=$lanes -I "$1/runtime/include" \
        -c "$1/tests/packaging/lanes_kept.cpp" -o /dev/null || { echo "$compiler $flags, $lanes lanes"; failed=1; }
    done
  done
done
exit $failed
