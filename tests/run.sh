#!/bin/sh
# sh tests/run.sh [CTEST OPTION...]   Installs what is missing, builds and runs every test; ends with ctest's summary.
#
# The benchmarks and the tests that need them (label benchmarks) are left to tests/long.sh: they are a fifth of the build.
set -eu
cd "$(dirname "$0")/.."

echo "== Packages"
sh cmake/setup.sh build example test
echo "== Configuring (build/release)"
cmake --preset release
echo "== Building"
cmake --build --preset release -j "$(nproc)" --target runtime/all generator/all tests/all examples/all
echo "== Testing"
exec ctest --preset release -j "$(nproc)" --label-exclude benchmarks "$@"
