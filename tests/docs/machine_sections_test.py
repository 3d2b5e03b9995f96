"""The page of figures has a section per kind of machine, and a run replaces its own alone.

usage: machine_sections_test.py PROJECT DALEMBERT
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

project, dalembert = pathlib.Path(sys.argv[1]), sys.argv[2]
sys.path.insert(0, str(project / "tests/benchmarks"))
import machine  # noqa: E402
import machine_sections  # noqa: E402
import table  # noqa: E402


def demand(good, what):
    if not good:
        sys.exit(f"machine_sections_test: {what}")


def section(kind, time):
    return (f"## {kind}\n\n2026-01-02, one core of {kind} (2 cores; 3.0 GHz); c++ 12.2.0, generated code with -O3; load\n\n"
            f"{table.AGAINST_MUJOCO}\n\n" + table.table(["", "ours", "error", "MuJoCo", "error", "times faster"],
                                                        [["WAM M", time, "1e-16", "M: 9 ns", "2e-16", "3.00"]]) +
            "\n### Among ours\n\nnothing\n\n")


def with_run(page, kind, time):
    return table.page(machine_sections.with_section(page, kind, section(kind, time)), table.more(page))


old, new = "A chip, Zen 5; L1d 48 kB; AVX-512", "A chip, Zen 3; L1d 32 kB; AVX2"
page = with_run(with_run("", old, "1 ns"), new, "2 ns")
found = machine_sections.sections(page)
demand(list(found) == [old, new], f"the sections are {list(found)}")
again = with_run(page, new, "7 ns")
demand(machine_sections.sections(again)[old] == found[old], "another machine's section is not what it was")
demand("| WAM M | 1 ns | 3.00 | 7 ns | 3.00 |" in again and "2 ns" not in again, "the new figures do not take the old ones' place")
demand(list(machine_sections.sections(again)) == [old, new], "the order is another")
demand("A chip, Zen 5: ours | A chip, Zen 5: times faster | A chip, Zen 3: ours" in again, "the columns do not name their machines")

# The pages there are: what a run on another machine would leave of them, and what README says it shows.
page, readme = table.PAGE.read_text(), table.README.read_text()
there = machine_sections.sections(page)
demand(there and table.page(there, table.more(page)) == page, "docs/performance.md is not as table.py writes it: python3 tests/benchmarks/table.py")
after = with_run(page, "no machine; there is none", "1 ns")
demand(all(machine_sections.sections(after)[kind] == text for kind, text in there.items()), "a run elsewhere changes a section")
demand(table.more(page) and table.more(after) == table.more(page), "a run changes what stands behind the machines' sections")
both = {f"WAM/M/{who}": {"times": [time], "relative_error": 1e-16} for who, time in (("dalembert", 100.0), ("pinocchio", 300.0))}
demand("| WAM M | 100 ns | 1e-16 | 300 ns | 1e-16 | 3.00 |" in table.times(both, [{"name": "WAM", "base": "fixed"}], ["M"], "Pinocchio 3"),
       "Pinocchio's figures are not those measured")
demand("Pinocchio" not in table.times({}, [], ["M"]), "Pinocchio is missed where there is none")
kind = table.readme_kind(readme)
demand(kind in there, f"README's table is of '{kind}', of which docs/performance.md has no section")
demand(table.with_summary(readme, kind, there[kind]) == readme, "README's table is not that of its machine in docs/performance.md")
for text in (page, readme):
    demand(not re.search(r"asked for \||reached \||at most \|", text), "a table has targets")
for kind in there:
    demand(re.search(r"; L1d \d+ kB", kind) and re.search(r"AVX|SSE|NEON|SVE", kind), f"'{kind}' does not tell machines apart")

# A quick try, as table.py's own text has it, with programs in place of the benchmarks that take an hour to build.
with tempfile.TemporaryDirectory() as folder:
    build = pathlib.Path(folder)
    tables = build / "tests/benchmarks/tables"
    tables.mkdir(parents=True)
    (build / "bin").mkdir()
    (build / "CMakeCache.txt").write_text("CMAKE_CXX_COMPILER:FILEPATH=/usr/bin/c++\nCMAKE_BUILD_TYPE:STRING=Release\n")
    (tables / "robots.json").write_text(json.dumps([{"name": name, "urdf": str(project / "tests/robots/pendulum.urdf"), "base": "fixed"}
                                                    for name in ("WAM", "MAHRU")]))
    (tables / "outputs.json").write_text('{"M": "mass_matrix"}')
    (build / "bin/dalembert").symlink_to(pathlib.Path(dalembert).resolve())
    runs = [{"name": f"WAM/M/{who}", "run_name": f"WAM/M/{who}", "run_type": "iteration", "repetition_index": i, "cpu_time": 50.0 * i + 100,
             "relative_error": 1e-16, "text_bytes": 2048, "table_bytes": 512} for who in ("dalembert", "mujoco") for i in range(3)]

    def says(name, said):
        (build / name).write_text(f"#!/bin/sh\ncat <<'END'\n{said}\nEND\n")
        (build / name).chmod(0o755)

    def written(*options):
        run = subprocess.run([sys.executable, project / "tests/benchmarks/table.py", "--build", folder, "--robots", "WAM",
                              "--repetitions", "3", "--states", "100", "--output", f"{folder}/try/performance.md", *options],
                             capture_output=True, text=True, env=os.environ | {"PATH": f"{folder}:{os.environ['PATH']}"})
        demand(run.returncode == 0, f"a quick try ends with {run.returncode}: {run.stdout}{run.stderr}")
        return (build / "try/performance.md").read_text()

    says("bin/benchmark_peers", json.dumps({"context": {}, "benchmarks": runs}))
    says("bin/accuracy", "robot base library quantity states max median over generic\nWAM fixed M M 100 1 1 0 1")
    says("cmake", "")
    tried = written()
    for part in ("| WAM M | 150 ns | 1e-16 | M: 150 ns | 1e-16 | 1.00 |", "#### WAM, fixed base", "| WAM | fixed | M | M | 100 |", "2.0 kB"):
        demand(part in tried, f"a quick try does not write '{part}': {tried}")
    demand("MAHRU |" not in tried and re.search(r"\n\d{4}-\d\d-\d\d, dalembert [\d.]+, one core of ", tried), f"the try says {tried}")
    theirs = [run | {"run_name": "WAM/M/pinocchio", "cpu_time": 4 * run["cpu_time"]} for run in runs if "dalembert" in run["name"]]
    says("bin/benchmark_peers", json.dumps({"context": {"pinocchio": "Pinocchio 3"}, "benchmarks": runs + theirs}))
    for _ in range(2):  # the second takes the first's place
        beside = written("--pinocchio")
        begin, end = beside.index(table.AGAINST_PINOCCHIO), beside.index(table.AMONG_OURS)
        demand(beside[:begin] + beside[end:] == tried, f"Pinocchio's table changes what is not its own: {beside}")
        demand(re.search(r"Pinocchio 3\.\n\n[\d-]+, dalembert .*\n\n(.*\n)*\| WAM M \| 150 ns \| 1e-16 \| 600 ns \| 1e-16 \| 4.00 \|\n",
                         beside[begin:end]), f"Pinocchio's table is {beside[begin:end]}")

kind, details = machine.described(dalembert)
demand(machine.text(dalembert) == f"{kind} ({details})" and kind and details, "the machine has no name")
print(f"{', '.join(there)}; this is {kind} ({details})")
