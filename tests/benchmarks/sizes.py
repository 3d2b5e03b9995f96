#!/usr/bin/env python3
"""What size costs: time of M and C per operation, on humanoids of 25 to 55 joints.

    python3 tests/benchmarks/sizes.py [--build build/release] [--rounds 15] [--include runtime/include] [--cxx g++]

Generates each robot's M and C (floating base), compiles them with -O3 -march=native, and times them in turn, round by round,
with Google Benchmark (tests/benchmarks/one_robot.cpp), each time from a copy of the program of its own (measure.py says why).
Prints a Markdown table: operations as written and as executed (with padding), bytes of code and constants, nanoseconds of
processor time (median of the rounds), and nanoseconds per thousand executed and written operations as a multiple of MAHRU's
(median of the rounds' ratios). --include times the same generated code with the runtime's headers of another commit.
"""
import argparse
import json
import pathlib
import subprocess
import tempfile

import measure

ROOT = pathlib.Path(__file__).resolve().parents[2]
DATA = pathlib.Path("/usr/share/doc/dart/data")
ROBOTS = {"MAHRU": ROOT / "examples/mahru/mahru.urdf", "Atlas": DATA / "sdf/atlas/atlas_v3_no_head.urdf",
          "humanoid_29": ROOT / "tests/robots/humanoid_29.urdf", "humanoid_39": ROOT / "tests/robots/humanoid_39.urdf",
          "DRC-Hubo": DATA / "urdf/drchubo/drchubo.urdf", "humanoid_55": ROOT / "tests/robots/humanoid_55.urdf"}
OPTIONS = ["--base", "floating", "--outputs", "mass_matrix,coriolis_matrix"]


def output_of(*command):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          text=True).stdout


class Robot:
    def __init__(self, name, urdf, options, folder):
        self.name, self.times = name, []
        dalembert = options.build / "bin" / "dalembert"
        info = json.loads(output_of(dalembert, "info", "--json", urdf, *OPTIONS))
        self.nv = info["nv"]
        self.written = sum(info["quantities"]["all"][k] for k in ("add", "multiply", "divide"))
        self.executed = sum(info["executed"]["evaluate"][k] for k in ("add", "multiply", "divide"))
        code, self.program = folder / "robot", folder / "time"
        output_of(dalembert, "generate", urdf, "-o", code, "--name", "robot", "--parallel", "serial", *OPTIONS)
        flags = ["-std=c++17", "-O3", "-march=native", "-DROBOT=robot", f"-I{code}", f"-I{options.include}", "-isystem",
                 "/usr/include/eigen3"]
        output_of(options.cxx, *flags, "-c", code / "dynamics.cpp", "-o", folder / "dynamics.o")
        self.bytes = int(output_of("size", folder / "dynamics.o").splitlines()[1].split()[0])
        output_of(options.cxx, *flags, ROOT / "tests/benchmarks/one_robot.cpp", folder / "dynamics.o", "-lbenchmark", "-lpthread",
                  "-o", self.program)

    def time(self):
        with measure.copied(self.program) as program:
            answer = output_of(program, "--benchmark_min_time=0.03", "--benchmark_format=json")
        self.times.append(json.loads(answer)["benchmarks"][0]["cpu_time"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--include", type=pathlib.Path, default=ROOT / "runtime/include")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--cxx", default="g++")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as work:
        robots = []
        for name, urdf in ROBOTS.items():
            if not urdf.exists():
                print(f"sizes.py: {name} is left out: there is no {urdf} (Debian's package dart-doc)")
                continue
            folder = pathlib.Path(work) / name
            folder.mkdir()
            robots.append(Robot(name, urdf, options, folder))
        for turn in range(options.rounds):
            for robot in robots if turn % 2 == 0 else reversed(robots):
                robot.time()
    first = robots[0]
    print("| robot | nv | written | executed | code, bytes | ns | per executed | per written |")
    print("| --- |" + " ---: |" * 7)
    for r in robots:
        ratio = measure.median([a / b for a, b in zip(r.times, first.times)])
        print(f"| {r.name} | {r.nv} | {r.written} | {r.executed} | {r.bytes} | {measure.median(r.times):.0f} "
              f"± {measure.spread(r.times):.0%} | {ratio * first.executed / r.executed:.2f} | "
              f"{ratio * first.written / r.written:.2f} |")


if __name__ == "__main__":
    main()
