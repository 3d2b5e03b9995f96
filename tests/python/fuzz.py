"""Thousands of made-up calls of robots whose code, and the module that calls it, have the address and undefined-behaviour sanitizers in
them. Ends with status 0 where nothing is found.

usage: fuzz.py [--cases 10000] [--build build/release]
"""

import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import sysconfig
import tempfile

project = pathlib.Path(__file__).resolve().parents[2]
SANITIZED = "-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined"


def compiler_file(name):
    return subprocess.run(["c++", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()


def outside(options):
    """Builds the sanitized module, and runs this file again with it."""
    import numpy
    built = options.build.resolve()
    with tempfile.TemporaryDirectory(prefix="dalembert.fuzz.") as folder:
        package = pathlib.Path(folder) / "dalembert"
        shutil.copytree(built / "python/dalembert", package, ignore=shutil.ignore_patterns("_core*", "__pycache__"))
        includes = [sysconfig.get_path("include"), numpy.get_include(), project / "runtime/include", "/usr/include/eigen3"]
        subprocess.run(["c++", "-std=c++17", "-shared", "-fPIC", "-fvisibility=hidden", *SANITIZED.split(),
                        *(word for include in includes for word in ("-isystem", str(include))),
                        *map(str, sorted((project / "runtime/python").glob("*.cpp"))),
                        "-o", str(package / ("_core" + sysconfig.get_config_var("EXT_SUFFIX")))], check=True)
        environment = dict(os.environ, PYTHONPATH=folder, DALEMBERT_TEST_PROJECT=str(project), DALEMBERT_FUZZ_INSIDE="1",
                           DALEMBERT_EXECUTABLE=str(built / "bin/dalembert"), DALEMBERT_TEST_CACHE=str(pathlib.Path(folder) / "cache"),
                           LD_PRELOAD=f"{compiler_file('libasan.so')} {compiler_file('libstdc++.so')}",
                           ASAN_OPTIONS="detect_leaks=0:allocator_may_return_null=1", UBSAN_OPTIONS="print_stacktrace=1")
        return subprocess.run([sys.executable, __file__, "--cases", str(options.cases)], env=environment).returncode


def inside(options):
    import warnings
    import made_up
    import robots
    import dalembert
    warnings.simplefilter("ignore", dalembert.InputWarning)
    urdf, flags = robots.robot("double_pendulum"), "-std=c++17 " + SANITIZED
    made_up.right_or_refused([
        dalembert.load(urdf, base="floating", outputs=["mass_matrix", "forward_dynamics"], gravity="run_time", payloads=["link_02"],
                       wrenches={"link_02": "world"}, functions={"both": ["bias", "center_of_mass", "pose_link_02"]}, flags=flags, batch=True),
        dalembert.load(urdf, scalar="float", base="fixed", outputs=["mass_matrix", "forward_dynamics"], flags=flags, batch=False),
        dalembert.load(urdf, base="fixed", outputs=["forward_dynamics"], payloads=["link_02"], flags=flags, batch=True),
    ], options.cases)
    print(f"{options.cases} cases: each right or refused, and nothing that the sanitizers object to")
    return 0


parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
parser.add_argument("--cases", type=int, default=10000)
parser.add_argument("--build", type=pathlib.Path, default=project / "build/release")
arguments = parser.parse_args()
sys.exit(inside(arguments) if os.environ.get("DALEMBERT_FUZZ_INSIDE") else outside(arguments))
