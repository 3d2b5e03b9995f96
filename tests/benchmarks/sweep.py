#!/usr/bin/env python3
"""The paper's experiments, measured and drawn: docs/sweep.csv, docs/sweep_*.svg and their tables in docs/performance.md.

    python3 tests/benchmarks/sweep.py [--build build/release] [--repetitions 5] [--results FILE.json] [--output docs]

Builds and runs benchmark_sweep, which generates and compiles the robots itself, and draws with gnuplot. Times are by the clock on
the wall, medians of repetitions that are interleaved at random. --results draws from an earlier run's JSON instead of running.
Takes some four minutes on two idle cores; run it on an idle machine. Nothing is written unless everything succeeded.
"""
import argparse
import collections
import csv
import io
import json
import os
import pathlib
import re
import subprocess

import measure
import table

ROOT = pathlib.Path(__file__).resolve().parents[2]
WAYS = {"generic": "generic, one thread", "generic_loops": "generic, loops and barriers", "generic_tasks": "generic, the paper's tasks",
        "dalembert": "generated, one thread", "dalembert_tasks": "generated, task graph"}
COLOURS = dict(zip(WAYS, ("#7f7f7f", "#d62728", "#ff7f0e", "#1f77b4", "#2ca02c")))
FAMILIES = {1: "chain", 2: "2 branches", 5: "5 branches", 10: "10 branches"}
QUANTITIES = ["M", "C", "M+C"]
Key = collections.namedtuple("Key", "branches joints quantities way")  # no branches: MAHRU
Figure = collections.namedtuple("Figure", "time spread error")


def run(build, repetitions):
    subprocess.run(["cmake", "--build", build, "--target", "benchmark_sweep"], check=True)
    command = [build / "bin/benchmark_sweep", f"--benchmark_repetitions={repetitions}", "--benchmark_min_time=0.02",
               "--benchmark_enable_random_interleaving=true", "--benchmark_format=json"]
    return subprocess.run([str(c) for c in command], check=True, stdout=subprocess.PIPE, text=True).stdout


def figures(answer):
    times, errors = collections.defaultdict(list), {}
    for entry in json.loads(answer)["benchmarks"]:
        if entry.get("run_type") != "iteration":
            continue
        if entry.get("error_occurred"):
            raise SystemExit(f"{entry['run_name']}: {entry['error_message']}")
        robot, quantities, way = entry["run_name"].split("/")[:3]
        kind, *numbers = robot.split("_")  # chain_JOINTS, tree_JOINTS_BRANCHES
        joints, branches = {"MAHRU": [25, 0], "chain": [*map(int, numbers), 1], "tree": [*map(int, numbers)]}[kind]
        key = Key(branches, joints, quantities, way)
        times[key].append(entry["real_time"])
        errors[key] = entry["relative_error"]
    return {k: Figure(measure.median(t), measure.spread(t), errors[k]) for k, t in times.items()}


def joints_of(found, branches):
    return sorted({k.joints for k in found if k.branches == branches})


def csv_text(found):
    text = io.StringIO()
    lines = csv.writer(text, lineterminator="\n")
    lines.writerow(["branches", "joints", "quantities", "who", "time_ns", "spread", "relative_error"])
    for k in sorted(found, key=lambda k: (k.branches, k.joints, QUANTITIES.index(k.quantities), list(WAYS).index(k.way))):
        lines.writerow([k.branches or "MAHRU", k.joints, k.quantities, k.way, f"{found[k].time:.1f}", f"{found[k].spread:.3f}",
                        f"{found[k].error:.2e}"])
    return text.getvalue()


def plot(found, quantities, value, label, ways, log=True):
    """One picture with a panel per family, each with a curve per way."""
    data, curves = [], {}
    for branches in FAMILIES:
        for way in ways:
            points = [(n, value(Key(branches, n, quantities, way))) for n in joints_of(found, branches)
                      if Key(branches, n, quantities, way) in found]
            name = f"$d{branches}_{way}"
            data.append(f"{name} << EOD\n" + "\n".join(f"{n} {y:.6g}" for n, y in points) + "\nEOD\n")
            curves.setdefault(branches, []).append(
                f"{name} with linespoints linewidth 2 pointtype 7 pointsize 0.4 linecolor rgb '{COLOURS[way]}' title \"{WAYS[way]}\"")
    values = [value(k) for k in found if k.quantities == quantities and k.way in ways and k.branches]
    low, high = min(values), max(values)
    script = "".join(data) + f"""set terminal svg size 900,680 font 'sans,12' background rgb 'white'
set multiplot layout 2,2
set logscale x
{'set logscale y' if log else ''}
set format {"y '10^{%T}'" if log else "y '%g'"}
set yrange [{low / 1.3 if log else 0:.6g}:{high * 1.3:.6g}]
set xrange [8:600]
set xtics (10,20,50,100,200,500)
set grid
set key {'top left' if log else 'top left'} Left reverse font 'sans,9' samplen 2
set xlabel 'joints'
set ylabel '{label}'
"""
    for branches, name in FAMILIES.items():
        script += f"set title '{name}'\nplot {', '.join(curves[branches])}\nunset key\n"
    svg = subprocess.run(["gnuplot"], input=script, check=True, stdout=subprocess.PIPE, text=True).stdout
    return re.sub(r"<desc>.*?</desc>\n?", "", svg, flags=re.S)  # names gnuplot's version


def time_table(found, quantities):
    rows = []
    shapes = [(0, 25)] + [(b, n) for b in FAMILIES for n in joints_of(found, b)]
    for branches, joints in shapes:
        at = {way: found.get(Key(branches, joints, quantities, way)) for way in WAYS}
        if not all(at.values()):
            continue
        best = min(at["dalembert"].time, at["dalembert_tasks"].time)
        rows.append([f"{FAMILIES[branches]}, {joints}" if branches else "MAHRU"] +
                    [f"{measure.duration(f.time)} ± {f.spread:.0%}" for f in at.values()] +
                    [f"{at['generic'].time / at['generic_loops'].time:.2f}", f"{at['generic'].time / at['generic_tasks'].time:.2f}",
                     f"{at['dalembert'].time / at['dalembert_tasks'].time:.2f}", f"{at['generic'].time / best:.0f}"])
    return table.table(["joints"] + list(WAYS.values()) + ["loops", "paper's tasks", "task graph", "all in all"], rows)


def crossover(found, serial, parallel, quantities):
    """Per family: from how many joints on the parallel way is faster, at all larger sizes."""
    cells = []
    for branches in FAMILIES:
        first = None
        for n in reversed(joints_of(found, branches)):
            if found[Key(branches, n, quantities, parallel)].time >= found[Key(branches, n, quantities, serial)].time:
                break
            first = n
        cells.append(str(first) if first else "never")
    return cells


def crossover_table(found):
    rows = [[f"{q}: {WAYS[parallel]}"] + crossover(found, serial, parallel, q)
            for q in QUANTITIES
            for serial, parallel in (("generic", "generic_loops"), ("generic", "generic_tasks"), ("dalembert", "dalembert_tasks"))]
    return table.table(["faster than one thread from … joints on"] + list(FAMILIES.values()), rows)


def error_table(found):
    rows = []
    for branches in FAMILIES:
        for n in joints_of(found, branches):
            rows.append([f"{FAMILIES[branches]}, {n}"] +
                        [f"{found[Key(branches, n, q, way)].error:.1e}" for way in ("generic", "dalembert") for q in ("M", "C")])
    return table.table(["joints", "generic M", "generic C", "generated M", "generated C"], rows)


def between(text, marker, content):
    pattern = re.compile(rf"(<!-- {re.escape(marker)} -->\n).*?(<!-- /{re.escape(marker)} -->)", re.S)
    if not pattern.search(text):
        raise SystemExit(f"sweep.py: the page has no place for '{marker}'")
    return pattern.sub(lambda m: m.group(1) + content + m.group(2), text)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--repetitions", type=int, default=5)
    parser.add_argument("--results", type=pathlib.Path)
    parser.add_argument("--output", type=pathlib.Path, default=ROOT / "docs")
    options = parser.parse_args()
    where = table.provenance(options.build).replace("one core of", "two cores of" if os.cpu_count() == 2 else f"{os.cpu_count()} cores of")
    if os.getloadavg()[0] > 0.5:
        where += (" The machine was shared: the parallel ways had fewer cores than these, and ratios of neighbouring rows differ by "
                  "what others did.")
    found = figures(options.results.read_text() if options.results else run(options.build, options.repetitions))

    time = lambda k: found[k].time
    faster = lambda serial: lambda k: found[k._replace(way=serial)].time / found[k].time
    files = {"sweep.csv": csv_text(found)}
    for q in QUANTITIES:
        files[f"sweep_time_{q.replace('+', '')}.svg"] = plot(found, q, time, "ns", WAYS)
    files["sweep_speedup.svg"] = plot(found, "M+C", faster("generic"), "times faster than generic, one thread",
                                      ["generic_loops", "generic_tasks"], log=False)
    files["sweep_speedup_generated.svg"] = plot(found, "M+C", faster("dalembert"), "times faster than generated, one thread",
                                                ["dalembert_tasks"], log=False)
    files["sweep_error.svg"] = plot(found, "M+C", lambda k: found[k].error, "error of the largest element",
                                    ["generic", "dalembert"])
    page = (ROOT / "docs/performance.md").read_text()
    page = between(page, "where", where + "\n")
    for q in QUANTITIES:
        page = between(page, f"times {q}", time_table(found, q))
    page = between(page, "crossover", crossover_table(found))
    files["performance.md"] = between(page, "errors", error_table(found))
    for name, text in files.items():
        (options.output / name).write_text(text)
        print(options.output / name)


if __name__ == "__main__":
    main()
