#!/usr/bin/env python3
"""sanitized_test.py DALEMBERT RUNTIME EIGEN WORK: emitted code reads nothing that is not its own.

A robot of limbs that stand alone, of lengths around whole registers and with driven joints near their ends, so that runs of rows
begin anywhere; its self-test runs with the address and undefined-behaviour sanitizers. Exit status: 0
good, 1 not.
"""
import pathlib
import random
import subprocess
import sys

dalembert, runtime, eigen, work = sys.argv[1], sys.argv[2], sys.argv[3], pathlib.Path(sys.argv[4])
LIMBS = [("t", "root", 8), ("a", "t8", 13), ("b", "t8", 5)]  # name, the link it hangs on, joints
DRIVEN = {"t7": "t6", "a7": "a6", "b3": "b2"}
MAIN = """
#include <cstdio>
#include "robot/self_test.hpp"
int main() {
  robot::SelfTestReport report;
  const bool good = robot::self_test(&report);
  char text[512];
  dalembert::describe(report, text, sizeof text);
  std::printf("%s", text);
  return good ? 0 : 1;
}
"""


def robot():
    numbers = random.Random(5)

    def three(size):
        return " ".join(f"{numbers.uniform(-size, size):.4f}" for _ in range(3))

    def link(name):
        return (f'<link name="{name}"><inertial><origin xyz="{three(0.1)}"/><mass value="{numbers.uniform(1, 3):.4f}"/>'
                '<inertia ixx="0.05" iyy="0.06" izz="0.07" ixy="0.003" ixz="-0.004" iyz="0.005"/></inertial></link>')

    lines = [link("root")]
    for limb, parent, joints in LIMBS:
        for i in range(1, joints + 1):
            child = f"{limb}{i}"
            mimic = f'<mimic joint="{DRIVEN[child]}_joint" multiplier="0.7" offset="0.1"/>' if child in DRIVEN else ""
            lines += [link(child), f'<joint name="{child}_joint" type="continuous"><parent link="{parent}"/><child link="{child}"/>'
                                   f'<origin xyz="{three(0.3)}" rpy="{three(0.3)}"/><axis xyz="0.6 0.8 0"/>{mimic}</joint>']
            parent = child
    return "\n".join(['<robot name="runs">', *lines, "</robot>\n"])


def run(*command):
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    assert done.returncode == 0, done.stdout[-4000:]
    return done.stdout


work.mkdir(parents=True, exist_ok=True)
(work / "runs.urdf").write_text(robot())
(work / "main.cpp").write_text(MAIN)
for outputs, widths in (("mass_matrix", (2, 8)), ("mass_matrix,coriolis_matrix", (4,))):
    run(dalembert, "generate", work / "runs.urdf", "--name", "robot", "-o", work / "robot", "--base", "floating", "--form", "rolled",
        "--parallel", "serial", "--mimic", "urdf", "--outputs", outputs)
    for lanes in widths:
        run("g++", "-std=c++17", "-O1", "-fsanitize=address,undefined", "-fno-sanitize-recover=all", f"-DDALEMBERT_LANES={lanes}",
            "-I", work, "-I", runtime, "-isystem", eigen, work / "main.cpp", *sorted((work / "robot").glob("[ds]*.cpp")), "-o",
            work / "program")
        run(work / "program")
        print(f"{outputs}, {lanes} lanes: right, and nothing is read that is not there")
