#!/bin/sh
# sh tests/run.sh [CTEST OPTION...]   Installs what is missing, builds and runs every test; ends with ctest's summary.
#
# What is run before each landing: without the benchmarks, and without what DALEMBERT_LONG_TESTS adds. tests/long.sh has those.
set -eu
cd "$(dirname "$0")/.."

echo "== Packages"
sh cmake/setup.sh build example test
echo "== Configuring (build/release)"
cmake --preset release -DDALEMBERT_BUILD_BENCHMARKS=OFF -DDALEMBERT_LONG_TESTS=OFF
echo "== Building"
cmake --build --preset release -j "$(nproc)"
echo "== Testing"
exec ctest --preset release -j "$(nproc)" "$@"
