"""Runs benchmark_peers and reads what it says. Shared by table.py and compare.py; Python's standard library only."""
import contextlib
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import tempfile


@contextlib.contextmanager
def copied(program):
    """A copy of a program. Code larger than the instruction cache takes up to 1.3 times as long in one copy of the same file as in
    another, for as long as that copy lives: it is where its pages lie in memory that counts, and that is luck. So every round
    runs a copy of its own, and medians are over copies."""
    with tempfile.TemporaryDirectory() as folder:
        yield pathlib.Path(shutil.copy(program, folder))


def run(program, pattern, repetitions, min_time, copies=1):
    """{name: {"times": [CPU nanoseconds per repetition], counter: value}}, repetitions of all benchmarks interleaved; so many of
    each of the copies."""
    options = [f"--benchmark_filter={pattern}", f"--benchmark_repetitions={repetitions}", f"--benchmark_min_time={min_time}",
               "--benchmark_enable_random_interleaving=true", "--benchmark_format=json"]
    # A copy looks for what lies beside its original.
    environment = {"DALEMBERT_PINOCCHIO": str(pathlib.Path(program).resolve().parents[1] / "lib/libdalembert_pinocchio.so")} | os.environ
    found = {}
    for copy in range(copies):
        with copied(program) as own:
            answer = subprocess.run([str(own), *options], check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True,
                                    env=environment).stdout
        for entry in json.loads(answer)["benchmarks"]:
            if entry.get("run_type") != "iteration":
                continue
            if entry.get("error_occurred"):
                raise SystemExit(f"{entry['run_name']}: {entry['error_message']}")
            row = found.setdefault(entry["run_name"], {"times": {}})
            row["times"][copy, entry["repetition_index"]] = entry["cpu_time"]
            for counter in ("relative_error", "text_bytes", "table_bytes"):
                if counter in entry:
                    row[counter] = entry[counter]
    for row in found.values():
        row["times"] = [row["times"][i] for i in sorted(row["times"])]
    return found


def median(values):
    return statistics.median(values)


def spread(values):
    """Half the distance between the quartiles, as a part of the median."""
    if len(values) < 4:
        return (max(values) - min(values)) / 2 / median(values)
    low, _, high = statistics.quantiles(values, n=4)
    return (high - low) / 2 / median(values)


def ratio(numerator, denominator):
    """Median over the repetitions of numerator / denominator, repetition by repetition."""
    return median([a / b for a, b in zip(numerator["times"], denominator["times"])])


def names(program, pattern=""):
    command = [str(program), "--benchmark_list_tests=true"] + ([f"--benchmark_filter={pattern}"] if pattern else [])
    answer = subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True).stdout
    return [line for line in answer.splitlines() if re.fullmatch(r"[^/\s]+/[^/\s]+/[^/\s]+", line)]


def duration(nanoseconds):
    for limit, unit, scale in ((1e3, "ns", 1), (1e6, "µs", 1e3), (1e9, "ms", 1e6)):
        if nanoseconds < limit:
            return f"{nanoseconds / scale:.3g} {unit}"
    return f"{nanoseconds / 1e9:.3g} s"


def context(program):
    """What benchmark_peers says of itself, and of peers that it was built with. It says so where something runs: the first of all."""
    first = next(iter(names(program)), "none")
    answer = subprocess.run([str(program), f"--benchmark_filter=^{first}$", "--benchmark_min_time=0.000001", "--benchmark_format=json"],
                            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    start = answer.stdout.find("{")
    return json.loads(answer.stdout[start:]).get("context", {}) if start >= 0 else {}
