#!/bin/sh
# sh tests/run.sh [CTEST OPTION...]   Installs what is missing, builds and runs every test; ends with ctest's summary.
#
# What is run before each landing: without the benchmarks, and without what DALEMBERT_LONG_TESTS adds. tests/long.sh has those.
set -eu
cd "$(dirname "$0")/.."

echo "== Packages"
sh cmake/setup.sh build example test
echo "== Configuring (build/landing)"
cmake --preset landing
echo "== Building"
cmake --build --preset landing -j "$(nproc)"
echo "== Testing"
exec ctest --preset landing -j "$(nproc)" "$@"
