#!/usr/bin/env python3
"""Measures what docs/performance.md says of the machine it runs on, and writes that machine's section of the page.

    python3 tests/benchmarks/table.py [--build build/release] [--repetitions 21] [--states 10000] [--robots MAHRU,WAM] [--print]
                                      [--output docs/performance.md] [--readme] [--pinocchio]

Sections of other kinds of machines stay as they are, and so does what stands behind them: what scenes save (the target scenes_page)
and the paper's experiments (sweep.py). README's table, which names its machine, is written on the same kind of
machine, or with --readme. With --pinocchio only ours and Pinocchio's are timed, in turn, and only their table is written into
this machine's section, with a line of its own about when and how. Run it on an idle machine. It first builds what it measures, so that what is checked out is what is measured. Times are CPU
times of one core; each is the median of the repetitions, which are interleaved at random among all benchmarks of a robot;
ratios are medians of ratios, repetition by repetition. Nothing is written unless everything succeeded.
"""
import argparse
import datetime
import json
import os
import pathlib
import re
import resource
import subprocess
import sys
import tempfile

import machine
import machine_sections
import measure

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGE, README = ROOT / "docs/performance.md", ROOT / "README.md"
WHO = ["dalembert", "pinocchio", "mujoco", "dart", "kdl", "generic"]
MORE = "<!-- more -->\n"  # what others write stands behind it

# Ours, and what MuJoCo computes instead.
BESIDE_MUJOCO = [("MAHRU", "M+C", "M"), ("MAHRU", "M", "M"), ("MAHRU", "bias", "bias"), ("Atlas", "M+C", "M"), ("Atlas", "M", "M"),
                 ("Atlas", "bias", "bias"), ("DRC-Hubo", "M+C", "M"), ("DRC-Hubo", "M", "M"), ("DRC-Hubo", "bias", "bias"),
                 ("WAM", "M+C", "M"), ("WAM", "M", "M"), ("WAM", "bias", "bias"), ("MAHRU", "id", "id"), ("MAHRU", "fd", "fd"),
                 ("Atlas", "id", "id"), ("Atlas", "fd", "fd"), ("WAM", "id", "id"), ("WAM", "fd", "fd")]
# Among ours: the first's time over the second's.
BESIDE_OURS = [("minv", "M"), ("did", "M+C"), ("dfd", "M+C")]
AGAINST_MUJOCO, SIDE_BY_SIDE = "### Against MuJoCo", "## Machines side by side"
AGAINST_PINOCCHIO, AMONG_OURS = "### Against Pinocchio", "### Among ours"


def output_of(*command, **more):
    return subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE, text=True, **more).stdout


def table(header, rows):
    """Markdown: the first column to the left, the others to the right."""
    lines = [header, ["---"] + ["---:"] * (len(header) - 1)] + rows
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines) + "\n"


def provenance(build):
    cache = dict(re.findall(r"^(CMAKE_CXX_COMPILER|CMAKE_BUILD_TYPE):\w+=(.*)$", (build / "CMakeCache.txt").read_text(), re.M))
    compiler = output_of(cache["CMAKE_CXX_COMPILER"], "--version").splitlines()[0]
    changed = output_of("git", "-C", ROOT, "status", "--porcelain", "--untracked-files=no", "--", ".", ":!docs", ":!README.md").strip()
    version = output_of(build / "bin/dalembert", "--version").split(",")[0]
    return (f"{datetime.date.today().isoformat()}, {version}, one core of {machine.text(build / 'bin/dalembert')}; {compiler}, "
            f"generated code with -O3 -march=native{'; with changes that no commit has' if changed else ''}; "
            f"load average {os.getloadavg()[0]:.1f} before the measurement (0 on an idle machine).")


def cell(row):
    return f"{measure.duration(measure.median(row['times']))} ± {measure.spread(row['times']):.0%}, {row['relative_error']:.0e}" if row else ""


def mujoco_table(results):
    rows = []
    for robot, ours, theirs in BESIDE_MUJOCO:
        a, b = results.get(f"{robot}/{ours}/dalembert"), results.get(f"{robot}/{theirs}/mujoco")
        if a and b:
            rows.append([f"{robot} {ours}", measure.duration(measure.median(a["times"])), f"{a['relative_error']:.0e}",
                         f"{theirs}: {measure.duration(measure.median(b['times']))}", f"{b['relative_error']:.0e}",
                         f"{1 / measure.ratio(a, b):.2f}"])
    return table(["", "ours", "error", "MuJoCo", "error", "times faster"], rows)


def pinocchio_table(results, robots, quantities):
    rows = []
    for robot in robots:
        for q in quantities:
            a, b = (results.get(f"{robot['name']}/{q}/{who}") for who in ("dalembert", "pinocchio"))
            if a and b:
                rows.append([f"{robot['name']} {q}", measure.duration(measure.median(a["times"])), f"{a['relative_error']:.0e}",
                             measure.duration(measure.median(b["times"])), f"{b['relative_error']:.0e}", f"{1 / measure.ratio(a, b):.2f}"])
    return table(["", "ours", "error", "Pinocchio", "error", "times faster"], rows) if rows else ""


def own_table(results, robots):
    rows = []
    for robot in robots:
        for quantities, base in BESIDE_OURS:
            a, b = (results.get(f"{robot['name']}/{q}/dalembert") for q in (quantities, base))
            if a and b:
                rows.append([f"{robot['name']} {quantities}", measure.duration(measure.median(a["times"])),
                             f"{base}: {measure.duration(measure.median(b['times']))}", f"{measure.ratio(a, b):.2f}"])
    return table(["", "ours", "ours too", "times as long"], rows)


def time_tables(results, robots, quantities):
    text = ""
    for robot in robots:
        who = [w for w in WHO if any(f"{robot['name']}/{q}/{w}" in results for q in quantities)]
        rows = [[q] + [cell(results.get(f"{robot['name']}/{q}/{w}")) for w in who] for q in quantities]
        text += f"#### {robot['name']}, {robot['base']} base\n\n" + table([""] + who, [r for r in rows if any(r[1:])]) + "\n"
    return text


def cpu_seconds(action):
    """Processor time of the programs that the action runs: what others do on the machine does not count."""
    def used():
        usage = resource.getrusage(resource.RUSAGE_CHILDREN)
        return usage.ru_utime + usage.ru_stime
    start = used()
    action()
    return used() - start


def code_row(build, robot, results, quantities, outputs):
    """Generation and compile time of one library, measured here; its size and operations."""
    program = build / "bin" / "dalembert"
    options = ["--base", robot["base"], "--outputs", outputs]
    quiet = {"check": True, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with tempfile.TemporaryDirectory() as folder:
        where = pathlib.Path(folder) / "robot"
        generate = cpu_seconds(lambda: subprocess.run([program, "generate", robot["urdf"], "-o", where, "--name", "robot", *options], **quiet))
        includes = ["-I", folder, "-I", ROOT / "runtime/include", "-isystem", "/usr/include/eigen3"]
        compile_time = cpu_seconds(lambda: subprocess.run(
            ["g++", "-std=c++17", "-O3", "-march=native", *includes, "-c", where / "dynamics.cpp", "-o", pathlib.Path(folder) / "dynamics.o"],
            **quiet))
    info = json.loads(output_of(program, "info", "--json", robot["urdf"], *options, stderr=subprocess.DEVNULL))["quantities"]["all"]
    row = results[f"{robot['name']}/{quantities}/dalembert"]
    return [f"{robot['name']} {quantities}", f"{generate:.2f} s", f"{compile_time:.1f} s", f"{row['text_bytes'] / 1024:.1f} kB",
            f"{row['table_bytes'] / 1024:.1f} kB", info["add"], info["multiply"], info["divide"], info["sincos"]]


def code_table(build, robots, results, outputs):
    rows = [code_row(build, robot, results, q, outputs[q]) for robot in robots for q in outputs
            if f"{robot['name']}/{q}/dalembert" in results]
    return table(["", "generation", "compilation", "text", "tables", "add", "multiply", "divide", "sincos"], rows)


def accuracy_table(build, robots, states):
    """The accuracy program's own rows; it exits with 1 when its limit is exceeded, which the table must then show."""
    chosen = [part for robot in robots if not re.match("chain_|tree_", robot["name"]) for part in ("--robot", robot["name"])]
    if not chosen:
        return ""
    answer = subprocess.run([build / "bin" / "accuracy", "--states", str(states), *chosen], stdout=subprocess.PIPE, text=True)
    if answer.returncode not in (0, 1):
        sys.exit("accuracy failed")
    rows = [line.split() for line in answer.stdout.splitlines()[1:]]
    return table(["robot", "base", "library", "quantity", "states", "max ulp", "median ulp", "over", "generic max"], rows)


def beside_pinocchio(results, robots, quantities, pinocchio, measured_on=""):
    """The subsection; empty where there is no Pinocchio."""
    if not pinocchio:
        return ""
    said = f"{measured_on}\n\n" if measured_on else ""
    return f"{AGAINST_PINOCCHIO}\n\n{pinocchio}.\n\n{said}{pinocchio_table(results, robots, quantities)}\n"


def with_pinocchio(section, beside):
    """A machine's section with this subsection in the old one's place, or in front of ours alone."""
    old = section.find(AGAINST_PINOCCHIO)
    ours = section.index(AMONG_OURS)
    return section[:old if old >= 0 else ours] + beside + section[ours:]


def times(results, robots, quantities, pinocchio=None):
    beside = beside_pinocchio(results, robots, quantities, pinocchio)
    return f"""{AGAINST_MUJOCO}

{mujoco_table(results)}
{beside}{AMONG_OURS}

{own_table(results, robots)}
### Times

{time_tables(results, robots, quantities)}"""


def section(kind, build, robots, results, outputs, states, measured_on, pinocchio=None):
    """What the page says of one machine."""
    return f"""## {kind}

{measured_on}

{times(results, robots, outputs, pinocchio)}### Code

{code_table(build, robots, results, outputs)}
### Accuracy

{accuracy_table(build, robots, states)}
"""


def more(old):
    """What stands in the old page behind the machines' sections."""
    return old[old.index(MORE):] if MORE in old else ""


def page(all_sections, behind=""):
    head, rows = machine_sections.side_by_side(all_sections, AGAINST_MUJOCO, ["ours", "times faster"])
    below = "".join(machine_sections.section_text(kind, text) for kind, text in all_sections.items())
    return f"""# Performance

Written by `python3 tests/benchmarks/table.py`, which replaces the section of the kind of machine it runs on and leaves the others; do
not edit. Behind them: [what scenes save](#what-scenes-save), and [the paper's experiments](#the-papers-experiments-drawn-again).

All programs compute the same fused robot from the same 64 states in turn: state in, finished dense results out. *id* is inverse
dynamics, *did* its derivatives by q and by v; *fd* is forward dynamics, *dfd* its derivatives by q, v and τ, the latter being *minv*,
the inverse of M; *cmm* is the centroidal momentum matrix, *com* the centre of mass and its Jacobian, *energy* both energies.

MuJoCo (Debian's build) works in its own coordinates of the floating base and without constraints: `mj_kinematics, mj_comPos`, then for
M `mj_crb, mj_fullM`; for bias and g `mj_comVel, mj_rne`, for id the same with accelerations; for fd `mj_crb, mj_factorM, mj_comVel,
mj_rne, mj_solveM`; for minv `mj_crb, mj_factorM, mj_solveM` of the identity; for com `mj_jacSubtreeCom`; for energy `mj_crb,
mj_energyPos, mj_energyVel`. DART and KDL are Debian's builds as well; DART's inverse of M is wrong beyond welded links and left out.
Pinocchio, where a section has it, is built from its headers by the compiler named there, once for all robots: joints about
coordinate axes of their own types, the free flyer as the floating base; of M and forward dynamics the faster of its two conventions,
M and its inverse filled to both triangles, *did* with M and *dfd* with its inverse in one call; its C is of Christoffel symbols.
*Against Pinocchio* is measured by itself, ours and its calls in turn, where a line above the table says when
(`python3 tests/benchmarks/table.py --pinocchio`); [report.md](report.md#pinocchio) says which calls, and how far all robots agree.
Whatever of a peer's is wrong by more than 1e-9 of the largest element is not timed: that there is a figure says that they agree.
*generic* is this project's generic engine, which is made to be read, not to be fast. An empty cell: not computed there. But for
Pinocchio no peer computes C.

*Against MuJoCo* and *among ours*: medians of times and of their ratios; largest errors relative to the largest element, against 50
digits. From run to run on a shared machine the ratios move by a few per cent, by ten when others keep it busy. *Times*: median ± half
the interquartile range of CPU time; then the largest error over 16 states, relative to the largest element, against 50 digits.
*Code*: processor time of `dalembert generate` and of compiling `dynamics.cpp` (g++ -O3 -march=native), bytes of machine code and of
constants, scalar operations of the emitted program. *Accuracy*: error in units of the last place of the largest exact element, over
random states; *over* counts the states beyond 32, *generic max* is the generic engine in double on the same states.

{SIDE_BY_SIDE}

Our time, and how many times faster that is than MuJoCo on the same machine.

{table(head, rows)}
{below}{behind}"""


def readme_kind(readme):
    """The kind of machine that README's table was measured on."""
    found = re.search(r"<!-- performance -->\nOn (.*?): one core, ", readme)
    return found[1] if found else None


README_ROWS = ("MAHRU M+C", "MAHRU bias", "MAHRU fd", "WAM M")


def with_summary(readme, kind, text):
    """README with four rows of the machine's table between its markers."""
    head, rule, *rows = text[text.index(AGAINST_MUJOCO):].split("\n### ")[0].strip().splitlines()[2:]
    rows = [row for name in README_ROWS for row in rows if row.startswith(f"| {name} |")]
    ours = "\n".join([head, rule, *rows])
    date, compiler = re.search(r"^(\d{4}-\d\d-\d\d), one core of .*?; ([^;]*?), generated", text, re.M).groups()
    summary = f"On {kind}: one core, {compiler}, -O3 -march=native, {date}.\n\n{ours}\n"
    start, end = "<!-- performance -->\n", "<!-- /performance -->"
    return readme[:readme.index(start) + len(start)] + summary + readme[readme.index(end):]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repetitions", type=int, default=21)
    parser.add_argument("--states", type=int, default=10000, help="of the accuracy table")
    parser.add_argument("--robots", help="only these, separated by commas")
    parser.add_argument("--print", action="store_true", help="print the tables of times, and write nothing")
    parser.add_argument("--output", type=pathlib.Path, default=PAGE)
    parser.add_argument("--readme", action="store_true", help="README's table is of this machine from now on")
    parser.add_argument("--pinocchio", action="store_true", help="time ours and Pinocchio's alone, and write their table alone")
    options = parser.parse_args()
    if options.robots and not options.print and options.output.resolve() == PAGE:
        parser.error("a section of some robots does not replace one of all: name another page with --output, or give --print")
    build = options.build.resolve()

    print("== Building", flush=True)
    subprocess.run(["cmake", "--build", str(build), "--target", "dalembert", "benchmark_peers", "accuracy"], check=True,
                   stdout=subprocess.DEVNULL)
    robots = json.loads((build / "tests/benchmarks/tables/robots.json").read_text())
    outputs = json.loads((build / "tests/benchmarks/tables/outputs.json").read_text())  # label → what is timed under it
    if options.robots:
        robots = [robot for robot in robots if robot["name"] in options.robots.split(",")]
    measured_on = provenance(build)
    pinocchio = measure.context(build / "bin/benchmark_peers").get("pinocchio")
    if options.pinocchio and not pinocchio:
        sys.exit("table.py: there is no Pinocchio: configure with -DDALEMBERT_PINOCCHIO=FOLDER and build dalembert_pinocchio")
    who = "(dalembert|pinocchio)$" if options.pinocchio else ""
    results = {}
    for robot in robots:
        print(f"== Timing {robot['name']}", flush=True)
        results.update(measure.run(build / "bin/benchmark_peers", f"^{robot['name']}/[^/]*/{who}", 1, 0.02, options.repetitions))
    if options.print:
        print(f"{measured_on}\n\n{times(results, robots, outputs, pinocchio)}", end="")
        return
    kind, _ = machine.described(build / "bin/dalembert")
    old = options.output.read_text() if options.output.exists() else ""
    if options.pinocchio:
        beside = beside_pinocchio(results, robots, outputs, pinocchio, measured_on)
        if kind not in machine_sections.sections(old):
            sys.exit(f"table.py: {options.output} has no section of this machine, '{kind}': measure it without --pinocchio first")
        text = with_pinocchio(machine_sections.sections(old)[kind], beside)
    else:
        print("== Code and accuracy", flush=True)
        text = section(kind, build, robots, results, outputs, options.states, measured_on, pinocchio)
    options.output.parent.mkdir(parents=True, exist_ok=True)
    options.output.write_text(page(machine_sections.with_section(old, kind, text), more(old)))
    readme = README.read_text()
    if options.output.resolve() == PAGE and (options.readme or readme_kind(readme) == kind):
        README.write_text(with_summary(readme, kind, text))
    print(f"== Wrote {options.output}")


if __name__ == "__main__":
    main()
