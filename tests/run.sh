#!/bin/sh
# sh tests/run.sh [CTEST OPTION...]   Installs what is missing, builds everything and runs every test; ends with ctest's summary.
set -eu
cd "$(dirname "$0")/.."

echo "== Packages"
sh cmake/setup.sh build example test
echo "== Configuring (build/release)"
cmake --preset release
echo "== Building"
cmake --build --preset release -j "$(nproc)"
echo "== Testing"
exec ctest --preset release -j "$(nproc)" "$@"
