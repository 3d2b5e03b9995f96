#!/bin/sh
# sh cmake/setup.sh GROUP...   Installs what is missing of the groups' Debian packages; does nothing, quickly, when all is there.
#
#   build     the generator, the libraries its code needs, and what the Python package is built with
#   example   the controller's plant (MuJoCo) and pictures (gnuplot, matplotlib)
#   test      test framework, second compiler, and the programs that results are compared with
#   fuzz      the compiler with a fuzzer in it, and valgrind: for tests/fuzz and tests/long.sh
#   sdf       libsdformat, by which the generator reads SDF; it is built without where there is none
#   farm      MPI and HDF5, for examples/farm, which is left out without; part of `test`
#   package   what the Debian package is checked with; its test is skipped without
#   torch     PyTorch, whose tensors dalembert.torch differentiates; its test is skipped without
#   matrix    further compilers and an emulator, for tests/matrix/run.py alone
set -eu

build="g++ cmake ninja-build pkg-config libeigen3-dev liburdfdom-dev libtinyxml-dev libfmt-dev libyaml-cpp-dev libcli11-dev libtbb-dev libboost-dev
       libjs-d3 python3-dev python3-numpy"
example="libmujoco-dev gnuplot-nox python3-matplotlib"
test="libgtest-dev clang g++-aarch64-linux-gnu make python3 libmujoco-dev libdart-dev libdart-utils-dev libdart-utils-urdf-dev
      libdart-external-ikfast-dev libassimp-dev libtinyxml2-dev dart-doc liborocos-kdl-dev libbenchmark-dev chromium-headless-shell python3-hypothesis"
fuzz="clang libclang-rt-dev valgrind"
farm="openmpi-bin libopenmpi-dev libhdf5-dev python3-h5py"
test="$test $farm"
sdf="libsdformat-dev"
package="lintian dpkg-dev"
torch="python3-torch"
matrix="g++-11 g++-12 clang-14 clang-16 clang-19 g++-aarch64-linux-gnu qemu-user"

wanted=""
for group in "$@"; do
  case $group in
    build) wanted="$wanted $build" ;;
    example) wanted="$wanted $example" ;;
    test) wanted="$wanted $test" ;;
    fuzz) wanted="$wanted $fuzz" ;;
    farm) wanted="$wanted $farm" ;;
    sdf) wanted="$wanted $sdf" ;;
    package) wanted="$wanted $package" ;;
    torch) wanted="$wanted $torch" ;;
    matrix) wanted="$wanted $matrix" ;;
    *) echo "setup.sh: no group '$group'; there are build, example, test, fuzz, farm, sdf, package, torch and matrix" >&2; exit 2 ;;
  esac
done

if ! command -v dpkg-query > /dev/null || ! command -v apt-get > /dev/null; then
  echo "-- Not a Debian system: expecting the equivalents of these packages:" $wanted
  exit 0
fi

installed=" $(dpkg-query -W -f '${db:Status-Status} ${Package}\n' 2> /dev/null | sed -n 's/^installed //p' | tr '\n' ' ')"
missing=""
for package in $wanted; do
  case "$installed" in
    *" $package "*) ;;
    *) missing="$missing $package" ;;
  esac
done
if [ -z "$missing" ]; then
  echo "-- All packages are installed"
  exit 0
fi

as_root=""
if [ "$(id -u)" -ne 0 ]; then
  as_root="sudo"
  if ! command -v sudo > /dev/null; then
    echo "setup.sh: these packages are missing:$missing; install them, or run this as root" >&2
    exit 1
  fi
fi
echo "-- Installing:$missing"
$as_root apt-get update -q
$as_root env DEBIAN_FRONTEND=noninteractive apt-get install -q -y --no-install-recommends $missing
