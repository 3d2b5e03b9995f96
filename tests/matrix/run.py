#!/usr/bin/env python3
"""Compiles generated code in many ways, runs its self-test, and tabulates what is right and what is not.

    python3 tests/matrix/run.py                  the whole matrix (some two hours on two cores), and tests/README.md's table anew
    python3 tests/matrix/run.py --slice ci       what `sh tests/run.sh` runs: less than a minute

The self-test compares with results that the generator computed in 50 digits. It is compiled once by the machine's own g++; a
cell of the matrix is one way to compile the code under test. Cells that were run before with the same code and compiler are not
run again. Needs the compilers of `sh cmake/setup.sh build test matrix`. Exit status: 0 good, 1 a cell is wrong, 77 nothing could
run.
"""
import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import subprocess
import sys
import threading
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import design
import emitted_code
import passed
import table
import toolchain

ROOT = pathlib.Path(__file__).resolve().parents[2]
# Of the code under test: users read no warnings either. Eigen is a system header, as it is to them.
WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Werror"]
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


def run(command, **more):
    """Exit status and output. A negative status is a signal's."""
    done = subprocess.run([str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, errors="replace",
                          **more)
    return done.returncode, done.stdout


def digest(code):
    names = [code.name, "dynamics.hpp", "self_test.cpp", "self_test.hpp"]
    return emitted_code.digest(path for path in [*(code.parent / name for name in names), *batch_of(code)])


def batch_of(code):
    """The files of its batches, if it has any."""
    return [path for path in (code.parent / "batch.cpp", code.parent / "batch.hpp") if path.exists()]


class Matrix:
    def __init__(self, options):
        self.options = options
        self.work = pathlib.Path(options.work)
        self.work.mkdir(parents=True, exist_ok=True)
        self.include = ["-std=c++17", "-I", ROOT / "runtime/include", "-isystem", options.eigen]
        self.lock, self.locks, self.generated = threading.Lock(), {}, set()
        self.passed, self.remembered = passed.Passed(options.passed or self.work / "passed.txt"), 0

    def once(self, name):
        with self.lock:
            return self.locks.setdefault(name, threading.Lock())

    def program(self, program, host):
        """The code under test, and its self-test compiled by `host`."""
        robot, form, outputs = program
        folder = self.work / "_".join([robot, form, design.name(outputs)])
        with self.once(folder):
            code, test = folder / "robot", folder / f"{host}.o"
            if folder not in self.generated:
                status, text = run([self.options.dalembert, "generate", ROOT / design.URDFS[robot], "-o", code, "--name", "robot",
                                    "--form", form, "--parallel", "serial", *design.options(robot, outputs)])
                if status != 0:
                    raise RuntimeError(f"{robot}: {text}")
                (folder / "main.cpp").write_text(f'#include "robot/self_test.cpp"\n{MAIN}')
                self.generated.add(folder)
            newest = max(f.stat().st_mtime for f in [*code.iterdir(), ROOT / "runtime/include/dalembert/self_test.hpp"])
            if not test.exists() or test.stat().st_mtime < newest:
                status, text = run([host, "-O1", *self.options.precompiled.split(), *self.include, "-I", folder,
                                    "-c", folder / "main.cpp", "-o", test])
                if status != 0:
                    raise RuntimeError(text)
        return code / "dynamics.cpp", test

    def cell(self, number, cell):
        """(verdict, details): right, wrong, compiled (and not run), or absent (no such compiler or target)."""
        program, (compiler, level, target, lanes) = cell
        if not toolchain.there(compiler) or toolchain.macros(compiler, target) is None:
            return "absent", ""
        host = design.AARCH64 if target == "aarch64" else "g++"
        code, test = self.program(program, host)
        key = json.dumps([cell, toolchain.identity(compiler, target), digest(code), WARNINGS])
        name = hashlib.sha256(key.encode()).hexdigest()[:16]
        launch = toolchain.runner(compiler, target)
        before = self.passed.outcome(number, name)
        if before == "right" or before == "compiled" and launch is None:
            self.remembered += 1
            return before, ""
        binary, made, status, text = self.work / name, [], 0, ""
        for source in [code, *batch_of(code)[:1]]:
            made.append(self.work / f"{name}_{source.stem}.o")
            if status == 0:
                status, text = run([compiler, level, *WARNINGS, *toolchain.flags(target), f"-DDALEMBERT_LANES={lanes}",
                                    *self.include, "-c", source, "-o", made[-1]])
        result = ("wrong", "does not compile: " + text[-400:]) if status != 0 else ("compiled", "")
        if status == 0 and launch is not None:
            status, text = run([host, *made, test, "-o", binary])
            if status == 0:
                status, text = run([*launch, binary], timeout=100)
            result = ("right" if status == 0 else "wrong", text if status >= 0 else f"signal {-status}")
        for file in (*made, binary):
            file.unlink(missing_ok=True)
        if result[0] != "wrong":
            self.passed.add(number, name, result[0])
        return result

    def run(self, cells):
        verdicts = {}
        until = time.monotonic() + 60 * self.options.minutes if self.options.minutes else float("inf")
        with concurrent.futures.ThreadPoolExecutor(self.options.jobs) as pool:
            pending = {pool.submit(lambda *c: self.cell(*c) if time.monotonic() < until else ("not visited", ""), *numbered): numbered[1]
                       for numbered in enumerate(cells)}
            for n, job in enumerate(concurrent.futures.as_completed(pending), 1):
                cell = pending[job]
                verdict, details = verdicts[cell] = job.result()
                program, tools = cell
                if verdict == "not visited":
                    continue
                if verdict == "wrong" or not sys.stdout.isatty() or n % 10 == 0 or n == len(cells):
                    print(f"[{n}/{len(cells)}] {verdict:8} {' '.join(map(str, tools))}: {' '.join([*program[:2], design.name(program[2])])}"
                          f"{' | ' + details if verdict == 'wrong' else ''}", flush=True)
                if n % 20 == 0:
                    self.passed.write()
        self.passed.write()
        return verdicts


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slice", choices=["whole", "ci", "constraints", "batches"], default="whole")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--minutes", type=float, help="stop after so long")
    parser.add_argument("--dalembert", default=ROOT / "build/release/bin/dalembert")
    parser.add_argument("--eigen", default="/usr/include/eigen3")
    parser.add_argument("--precompiled", default="", help="flags by which g++ need not read Eigen for every self-test")
    parser.add_argument("--work", default=ROOT / "build/matrix")
    parser.add_argument("--passed", help="the file that remembers what was right; default: passed.txt in --work")
    parser.add_argument("--page", help="the page whose table is written; default: tests/README.md for the whole matrix, else none")
    options = parser.parse_args()

    robots = [name for name, path in design.ROBOTS.items() if (ROOT / path).exists()]
    cells = getattr(design, options.slice)(robots)
    matrix = Matrix(options)
    verdicts = matrix.run(cells)
    machine = run([options.dalembert, "--machine"])[1].splitlines()[0]
    text = table.written(verdicts, matrix.remembered, machine)
    page = options.page or (ROOT / "tests/README.md" if options.slice == "whole" else None)
    if page:
        table.insert(pathlib.Path(page), text)
    print(text)
    seen = {verdict for verdict, _ in verdicts.values()}
    return 1 if "wrong" in seen else 0 if "right" in seen else 77


if __name__ == "__main__":
    sys.exit(main())
