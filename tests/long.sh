#!/bin/sh
# sh tests/long.sh [--list] [--again] [--random N] [STAGE...]   Runs everything that is too long for sh tests/run.sh, one stage after
# another, and writes what came of it into tests/README.md.
#
# It may be stopped and gone on with: a stage whose row says that it has passed on this very tree is not run again, nor are cells of the
# matrix and compiled cases whose code is what it was when they were right.
set -eu
cd "$(dirname "$0")/.."
exec python3 tests/long.py "$@"
