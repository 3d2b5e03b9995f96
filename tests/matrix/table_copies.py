"""table_copies.py DALEMBERT PROJECT EIGEN WORK COMPILER   No emitted code copies a table of constants into the workspace.

g++ 12.2 expands a copy of constants wrongly where the target has AVX-512 or is tuned for it: of 32 or 64 bytes whose leading
words are equal and whose rest is zero, {a, a, 0, 0}, it writes {a, a, a, a}. Every loop that stores nothing but a table becomes
such a copy (-ftree-loop-distribute-patterns). Whether one does can be read in what the compiler makes of it on any machine, so
this test compiles and runs nothing. Exit status: 0 good, 1 a copy was found, 77 the compiler cannot tell.
"""
import concurrent.futures
import pathlib
import re
import subprocess
import sys

DALEMBERT, PROJECT, EIGEN, WORK, COMPILER = sys.argv[1:6]
PROJECT, WORK = pathlib.Path(PROJECT), pathlib.Path(WORK)
COPY = re.compile(r"__builtin_mem(?:cpy|move) \([^,]+, &(\w+)[^,]*, \d+\)")
# One that must be found: what the emitter used to write.
KNOWN = """
alignas(64) constexpr double table[24] = {0, 0, 0, 0, 0, 0, -0.794, -0.794, 0, 0, 0, 0, 0.03, 0.03, 0.011, 0.011, 0.042, 0.042};
void f(double* to) { for (int i = 0; i < 24; ++i) to[i] = table[i]; }
"""
# A robot of each shape of tables: one limb and several side by side, revolute and prismatic; every output of one.
ROBOTS = [("examples/mahru/mahru.urdf", "rolled", [])] + [
    (f"tests/robots/{robot}.urdf", form, ["--outputs", "gravity,bias"])
    for robot, form in [("chain_7", "rolled"), ("gantry", "rolled"), ("gantry", "straight"), ("gantry_arms", "rolled"),
                        ("hand", "rolled"), ("massless_intermediate", "rolled"), ("prismatic_mix", "straight"),
                        ("quadruped", "rolled"), ("skew_axes", "rolled"), ("unequal_limbs", "rolled")]]


def flags():
    """Those of a target with the defect where the compiler knows it; any other target shows the copies just as well."""
    target = ["-march=skylake-avx512"]
    known = subprocess.run([COMPILER, *target, "-E", "-x", "c++", "/dev/null"], capture_output=True)
    return ["-std=c++17", "-O3", *(target if known.returncode == 0 else [])]


def precompiled(include, options):
    """Options by which Eigen is read once and not for each robot."""
    header = WORK / "eigen.hpp"
    header.write_text("#include <Eigen/Core>\n")
    subprocess.run([COMPILER, *options, *include, "-x", "c++-header", header, "-o", f"{header}.gch"], check=True)
    return ["-include", header, *include]


def copies(source, include, options):
    """The tables that the code of `source` copies; what it has computed itself it may copy."""
    dump = source.with_suffix(".optimized")
    subprocess.run([COMPILER, *options, f"-fdump-tree-optimized={dump}", *include, "-S", source, "-o", "/dev/null"], check=True)
    tables = set(re.findall(r"constexpr \w+ (\w+)\[", source.read_text()))
    return [name for name in COPY.findall(dump.read_text()) if name in tables]


def of_robot(urdf, include, options, form, more):
    folder = WORK / f"{urdf.stem}_{form}"
    command = [DALEMBERT, "generate", urdf, "-o", folder, "--name", "robot", "--form", form, "--parallel", "serial", *more]
    made = subprocess.run(command, capture_output=True, text=True)
    if made.returncode != 0:
        return f"{urdf.name}: {made.stderr}"
    found = copies(folder / "dynamics.cpp", include, options)
    return f"{urdf.name}, {form}: copies {', '.join(found)}" if found else None


def main():
    if "Free Software Foundation" not in subprocess.run([COMPILER, "--version"], capture_output=True, text=True).stdout:
        print(f"SKIPPED: {COMPILER} is not g++")
        return 77
    WORK.mkdir(parents=True, exist_ok=True)
    options = flags()
    known = WORK / "known.cpp"
    known.write_text(KNOWN)
    if copies(known, [], options) != ["table"]:
        print(f"SKIPPED: {COMPILER} does not turn a loop into a copy")
        return 77
    include = precompiled(["-I", PROJECT / "runtime/include", "-isystem", EIGEN], options)
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        jobs = [pool.submit(of_robot, PROJECT / robot, include, options, form, more) for robot, form, more in ROBOTS]
        faults = [text for text in (job.result() for job in jobs) if text]
    print("\n".join(faults) or f"{len(jobs)} programs, no table copied")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
