#!/bin/sh
# sh examples/mahru/run.sh [CONTROLLER OPTION...]   From URDF to a running 1 kHz torque controller: installs what is missing, builds
# the generator, generates MAHRU's dynamics, compiles them into the controller and runs it. See README.md here.
set -eu
cd "$(dirname "$0")/../.."

echo "== Packages"
sh cmake/setup.sh build example
echo "== Configuring (build/example)"
cmake --preset example
echo "== Building the generator, generating and compiling the controller"
cmake --build --preset example -j "$(nproc)" --target mahru_controller
echo "== Running"
exec build/example/bin/mahru_controller --out build/example "$@"
