#!/bin/sh
# sh tests/run.sh [CTEST OPTION...]   Installs what is missing, builds and runs every test; ends with ctest's summary.
#
# Without the benchmarks, which are a fifth of the build, and the tests that need them: tests/long.sh has those.
set -eu
cd "$(dirname "$0")/.."

echo "== Packages"
sh cmake/setup.sh build example test
echo "== Configuring (build/release)"
cmake --preset release -DDALEMBERT_BUILD_BENCHMARKS=OFF
echo "== Building"
cmake --build --preset release -j "$(nproc)"
echo "== Testing"
exec ctest --preset release -j "$(nproc)" "$@"
