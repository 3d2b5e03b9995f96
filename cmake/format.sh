#!/bin/sh
# sh cmake/format.sh [--check]   Lays out every C++ file by .clang-format; with --check only says what is not so, and exits with 1.
set -eu
cd "$(dirname "$0")/.."

if ! command -v clang-format > /dev/null; then
  echo "format.sh: there is no clang-format; install Debian's package of that name" >&2
  exit 2
fi
how="-i"
if [ "${1-}" = "--check" ]; then how="--dry-run -Werror"; fi
git ls-files -z '*.cpp' '*.hpp' | xargs -0 clang-format $how
