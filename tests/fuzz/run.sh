#!/bin/sh
# sh tests/fuzz/run.sh [urdf|scene|all] [RUNS]   Builds the fuzzers with clang's sanitizers in build/fuzz and runs one or both,
# by default a million times each. Stops at the first crash, sanitizer report, broken invariant, input that takes more than a
# second of processor time, or memory beyond 2 GB. The input is then in build/fuzz/found; when the defect is corrected, it
# belongs into tests/fuzz/corpus.
set -eu
cd "$(dirname "$0")/../.."

targets="${1:-all}"
runs="${2:-1000000}"
case $targets in
  all) targets="urdf scene" ;;
  urdf | scene) ;;
  *) echo "run.sh: no target '$targets'; there are urdf, scene and all" >&2; exit 2 ;;
esac

sh cmake/setup.sh build fuzz
cmake --preset fuzz
cmake --build --preset fuzz
for target in $targets; do
  found="build/fuzz/found/$target"
  more="tests/error tests/robots"
  if [ "$target" = scene ]; then more="examples/scenes"; fi
  mkdir -p "$found"
  export ASAN_OPTIONS="quarantine_size_mb=8:malloc_context_size=2"
  echo "== fuzz_$target, $runs runs"
  "build/fuzz/bin/fuzz_$target" -runs="$runs" -max_len=1024 -timeout=30 -entropic=0 -rss_limit_mb=2048 -malloc_limit_mb=256 \
    -dict="tests/fuzz/$target.dict" -artifact_prefix="$found-" -print_final_stats=1 "$found" "tests/fuzz/corpus/$target" $more
done
