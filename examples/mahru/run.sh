#!/bin/sh
# sh examples/mahru/run.sh [CONTROLLER OPTION...]           From URDF to a running 1 kHz torque controller: installs what is missing,
# sh examples/mahru/run.sh --stand | --walk [OPTION...]   builds the generator, generates MAHRU's dynamics, compiles them into the
# controller, on a stand or on its feet, and runs it. See README.md here.
set -eu
cd "$(dirname "$0")/../.."

program=mahru_controller
for argument; do
  shift
  case $argument in
    --stand) program=mahru_standing; continue ;;
    --walk) program=mahru_standing ;;
  esac
  set -- "$@" "$argument"
done

echo "== Packages"
sh cmake/setup.sh build example
echo "== Configuring (build/example)"
cmake --preset example
echo "== Building the generator, generating and compiling the controller"
cmake --build --preset example -j "$(nproc)" --target $program
echo "== Running"
exec build/example/bin/$program --out build/example "$@"
