#!/bin/sh
# sh emitted_code_test.sh DALEMBERT PROJECT EIGEN WORK COMPILER [FLAG...]
#
# Generates six robots that between them use every form of emitted code, and compiles each emitted file with COMPILER FLAG...
# and warnings as errors, Eigen being a system header as it is to users. Without a FLAG also what must not compile: wrong_uses.cpp.
# Exit status: 0 good, 1 a file does not compile or shares functions or tables, or compiles and should not, 77 this machine cannot
# tell.
set -eu
dalembert=$1 project=$2 eigen=$3 work=$4 compiler=$5
shift 5

if ! command -v "$compiler" > /dev/null; then
  if command -v dpkg-query > /dev/null; then
    echo "$compiler is not there; 'sh cmake/setup.sh build test' installs it" >&2
    exit 1
  fi
  echo "SKIPPED: no $compiler on this machine"
  exit 77
fi
machine=$("$compiler" -dumpmachine)
case "$* $machine" in
  *-march=x86-64*' 'x86_64*) ;;
  *-march=x86-64*) echo "SKIPPED: $compiler compiles for $machine, not for x86-64"; exit 77 ;;
esac

rm -rf "$work"
mkdir -p "$work/headers"
generate_robot() {
  robot=$1
  urdf=$project/tests/robots/$robot.urdf
  [ -e "$urdf" ] || urdf=$project/tests/packaging/$robot.urdf
  shift
  "$dalembert" generate "$urdf" --name "$robot" -o "$work/$robot" "$@"
}
generate_robot quadruped --base floating --form rolled --parallel tasks \
  --outputs mass_matrix,coriolis_matrix,gravity,bias,mass_matrix_factor,forward_dynamics,inverse_mass_matrix
generate_robot prismatic_mix --base fixed --form straight --parallel serial
generate_robot hand --base fixed --form rolled --scalar float --parallel serial
# Loops over limbs that have nothing to read or to write.
generate_robot massless_fingers --base fixed --form rolled --parallel serial \
  --outputs kinetic_energy,center_of_mass,momentum_matrix,inverse_dynamics_dq
# States by lanes, and motions of a base that floats.
generate_robot double_pendulum --base floating --joints "{link_02_joint: spherical}" --parallel serial --outputs forward_dynamics --batch true --rollouts linearly_implicit

# Rows of contacts: inlined where code is optimised; with sanitizers parts of their kernels are functions that files share.
case "$*" in *-fsanitize=*) ;; *) generate_robot branch_below_base --base floating --parallel serial --contacts "{held: {link: c_03, type: point}}" \
  --outputs impact,constrained_inverse_dynamics ;;
esac

# oneTBB's headers are the same for every target; a cross compiler must see them without the rest of /usr/include.
for folder in oneapi tbb; do
  if [ -d "/usr/include/$folder" ]; then ln -s "/usr/include/$folder" "$work/headers/$folder"; fi
done

failed=0
for source in "$work"/*/*.cpp; do
  echo "-- $compiler $* ${source#"$work"/}"
  "$compiler" -std=c++17 -Wall -Wextra -Wpedantic -Wshadow -Werror -O1 "$@" -I "$work" -I "$project/runtime/include" -isystem "$eigen" \
    -isystem "$work/headers" -c "$source" -o "$source.o" || failed=1
  # A program may hold code for several targets: the linker must not take one's copy of a function for another's, nor of Eigen's
  # matrices, which are aligned otherwise there. But for the task graph, which is made of oneTBB's and the standard library's
  # functions, and those are shared whatever we do.
  if nm -C "$source.o" | grep -E ' (W .*dalembert::([A-Za-z]+(<[^<>]*>)?::)*~?[A-Za-z_]+[<(]|[VW] .*Eigen::Matrix<)' |
    grep -v 'dalembert::TaskGraph'; then
    echo "these functions of the runtime are not the file's own"
    failed=1
  fi
  # Nor may a table be one with another shared object's: that keeps an object loaded until the process ends.
  if readelf -sW --demangle "$source.o" | grep -E ' UNIQUE *DEFAULT .*(dalembert::|Eigen::Matrix<)'; then
    echo "these tables of the runtime are not the shared object's own"
    failed=1
  fi
done

if [ $# = 0 ]; then
  uses="$project/tests/packaging/wrong_uses.cpp"
  case $compiler in *clang*) all_errors=-ferror-limit=0 ;; *) all_errors=-fmax-errors=0 ;; esac
  echo "-- $compiler wrong_uses.cpp, which should not compile"
  LC_ALL=C "$compiler" -std=c++17 $all_errors -fsyntax-only -I "$work" -I "$project/runtime/include" -isystem "$eigen" \
    -isystem "$work/headers" "$uses" > "$work/errors" 2>&1 && failed=1
  grep -n '// error: ' "$uses" | while IFS= read -r line; do
    words=${line##*// error: }
    # As many errors of these words as uses that ask for them, and each use named.
    if [ "$(grep -c "[0-9]: error: .*$words" "$work/errors")" != "$(grep -c "// error: $words" "$uses")" ] ||
      ! grep -q "wrong_uses.cpp:${line%%:*}:" "$work/errors"; then
      echo "not refused, or not in these words: $line"
    fi
  done > "$work/accepted"
  if [ -s "$work/accepted" ] || [ ! -s "$work/errors" ]; then
    cat "$work/accepted" "$work/errors"
    failed=1
  fi
fi
exit $failed
