"""Everything that takes hours, by one command that may be stopped and gone on with: see tests/long.sh.

What is remembered, on another machine too, is in the repository: a row of the table in tests/README.md says what a stage was run on,
by a digest of its commands and of the files that it is about; passed.txt says which cells of the matrix and which compiled cases were
right. Exit status: 0 all stages asked for have passed, 1 one has failed, 2 a stage is asked for that there is none of. What it needs is
installed first; where that fails it is 1, too.
"""
import argparse
import dataclasses
import datetime
import hashlib
import os
import pathlib
import platform
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
LOGS = ROOT / "build" / "long"
README = ROOT / "tests" / "README.md"
COLUMNS = ["stage", "what", "came of it", "took", "when and where", "tree"]
JOBS = str(os.cpu_count())
# Without one of them a stage would leave out what it is for, and pass.
SETUP = ["sh", "cmake/setup.sh", "build", "example", "test", "sdf", "fuzz", "matrix"]


def workflow(preset, *options):
    return [["cmake", "--preset", preset, *options], ["cmake", "--build", "--preset", preset, "-j", JOBS],
            ["ctest", "--preset", preset, "-j", JOBS]]


def build_release(*targets, options=()):
    return [["cmake", "--preset", "release", *options], ["cmake", "--build", "--preset", "release", "-j", JOBS, "--target", *targets]]


# The defaults, but not behind `sh tests/run.sh` in the same folder.
LONG = "-DDALEMBERT_LONG_TESTS=ON"


@dataclasses.dataclass
class Stage:
    what: str
    commands: list
    environment: dict = dataclasses.field(default_factory=dict)  # more than the caller's
    about: tuple = (".", ":!docs", ":!*.md")  # the files that it is run on, as git's pathspecs


# What the generator is made of, and what it emits is compiled with.
GENERATOR = ("CMakeLists.txt", "CMakePresets.json", "cmake", "generator", "runtime", "templates")
STAGES = {
    "release": Stage("every test, those of benchmarks too", workflow("release", LONG, "-DDALEMBERT_BUILD_BENCHMARKS=ON"),
                     about=(".",)),
    "dev": Stage("the tests of sh tests/run.sh with the address and undefined-behaviour sanitizers", workflow("dev")),
    "tsan": Stage("what runs on threads, with the thread sanitizer", workflow("tsan")),
    "matrix": Stage("emitted code in many compilers",
                    [*build_release("bin/dalembert"), ["python3", "tests/matrix/run.py", "--passed", "tests/matrix/passed.txt"]],
                    about=(*GENERATOR, "tests/matrix", "tests/*.py", "tests/robots", "tests/numeric/generated/mechanisms", "examples/mahru/*.urdf")),
    "fuzz": Stage("URDFs and scenes, a million each", [["sh", "tests/fuzz/run.sh", "all", "1000000"]],
                  about=(*GENERATOR, "tests/CMakeLists.txt", "tests/fuzz", "tests/error", "tests/robots", "examples/scenes")),
    "random": Stage("scenes and robots drawn at random, interpreted, some in valgrind; every quantity alone of large robots",
                    [*build_release("random_scenes_test", "algorithm_test", "constraints_test", options=[LONG]),
                     ["ctest", "--preset", "release", "-j", JOBS, "--timeout", "7200", "-R", "^(RandomScenes|RandomRobots|Algorithm|Constraints)[.]"],
                     # What is read before it is set, which no sanitizer of these compilers finds.
                     ["env", "DALEMBERT_RANDOM_SCENES=24", "DALEMBERT_RANDOM_ROBOTS=60", "valgrind", "--quiet", "--error-exitcode=1",
                      "build/release/bin/random_scenes_test", "--gtest_filter=RandomRobots.*:*/quadruped:*/hand:*/frames_without_inertia"]],
                    {"DALEMBERT_RANDOM_SCENES": "300", "DALEMBERT_RANDOM_ROBOTS": "10000", "DALEMBERT_LARGE_ROBOTS": "1"}),
    "compiled": Stage("robots and scenes drawn at random, compiled",
                      [*build_release("bin/dalembert"), ["python3", "tests/random/compiled.py", "build/release/bin/dalembert",
                                                         "--cases", "500", "--passed", "tests/random/passed.txt"]],
                      about=(*GENERATOR, "tests/random", "tests/*.py", "tests/matrix/toolchain.py")),
}


def state_of_tree(stage):
    """A digest of the stage's commands and of the files that it is about, committed or not."""
    files = [*STAGES[stage].about, ":!tests/README.md", ":!tests/long.*", ":!tests/*/passed.txt"]
    commands = [[word for word in command if word != JOBS] for command in STAGES[stage].commands]
    digest = hashlib.sha256(repr((commands, STAGES[stage].environment)).encode())
    for words in (["ls-files", "--stage"], ["diff", "HEAD"], ["status", "--porcelain"]):
        digest.update(subprocess.run(["git", *words, "--", *files], cwd=ROOT, capture_output=True, check=True).stdout)
    return digest.hexdigest()[:16]  # longer than what git prints of commits, which tests/docs keeps out of pages


def machine():
    """The processor as the kernel calls it, with what tells its generation."""
    cpuinfo = pathlib.Path("/proc/cpuinfo")
    fields = dict(re.findall(r"^([\w ]+?)\s*: (.*)$", cpuinfo.read_text() if cpuinfo.exists() else "", re.M))
    name = fields.get("model name", platform.machine())
    return name + (f" (family {fields['cpu family']}, model {fields['model']})" if "cpu family" in fields else "") + f", {JOBS} cores"


def in_words(seconds):
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{seconds:.0f} s"


def run(command, environment, log):
    """Whether a command succeeds; its output goes to the log, its last line to the screen now and then."""
    print("   $ " + " ".join(command), flush=True)
    with open(log, "ab") as out:
        process = subprocess.Popen(command, cwd=ROOT, stdout=out, stderr=subprocess.STDOUT, env={**os.environ, **environment})
        said = time.time()
        try:
            while process.poll() is None:
                time.sleep(1)
                if time.time() - said >= 60:
                    said = time.time()
                    lines = log.read_bytes()[-4000:].decode(errors="replace").split("\n")
                    print("     " + next((x.strip() for x in reversed(lines) if x.strip()), "")[:110], flush=True)
        except KeyboardInterrupt:
            process.terminate()
            process.wait()
            raise
    return process.returncode == 0


def result_in(text):
    """What the tools say in the end, in few words."""
    skipped = text.count("***Skipped")
    found = [f"{m[1]} tests, {m[0]} failed" + (f", {skipped} skipped" if skipped else "")
             for m in re.findall(r"(\d+) tests? failed out of (\d+)", text)]
    found += re.findall(r"(\d+ cells: \d+ right, \d+ wrong|\d+ cases: \d+ right, \d+ refused by name, \d+ wrong)", text)
    found += [f"{m} known from runs before" for m in re.findall(r"(\d+)(?: of them)? known from runs before", text)]
    found += [f"{m} runs" for m in re.findall(r"stat::number_of_executed_units:\s+(\d+)", text)]
    return "; ".join(dict.fromkeys(found[-2:]))


def table():
    """{stage: its row's cells}, of the stages that were run."""
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in README.read_text().splitlines() if line.startswith("| `")]
    return {row[0].strip("`"): row for row in rows if row[0].strip("`") in STAGES and len(row) == len(COLUMNS)}


def write_row(row):
    rows = {**table(), row[0].strip("`"): row}
    lines = ["| " + " | ".join(COLUMNS) + " |", "|---|---|---|---:|---|---|"]
    lines += ["| " + " | ".join(rows[stage]) + " |" for stage in STAGES if stage in rows]
    text = "<!-- long -->\n" + "\n".join(lines) + "\n<!-- /long -->"
    README.write_text(re.sub(r"<!-- long -->.*?<!-- /long -->", lambda _: text, README.read_text(), flags=re.S))


def row_of_this_tree(stage):
    row = table().get(stage)
    return row if row is not None and row[5] == f"`{state_of_tree(stage)}`" else None


def passed_here(stage):
    row = row_of_this_tree(stage)
    return row is not None and row[2].startswith("passed")


def said_of(stage):
    row = table().get(stage)
    if row is None:
        return "not run yet"
    return f"{row[2]} on {'this' if row == row_of_this_tree(stage) else 'another'} tree, {row[3]}, {row[4]}"


def run_stage(name, log, again):
    """Whether it passes; writes its row."""
    stage, tree, begun = STAGES[name], state_of_tree(name), time.time()
    for command in stage.commands if again else []:
        if "--passed" in command:
            (ROOT / command[command.index("--passed") + 1]).unlink(missing_ok=True)
    log.write_bytes(b"")
    passed = all(run(command, stage.environment, log) for command in stage.commands)
    took, outcome = in_words(time.time() - begun), "passed" if passed else "FAILED"
    found = result_in(log.read_text(errors="replace"))
    print(f"   {outcome}; {found} after {took}", flush=True)
    where = f"{datetime.date.today()}, {machine()}"
    write_row([f"`{name}`", stage.what, f"{outcome}; {found}".strip("; "), took, where, f"`{tree}`"])
    return passed


def main():
    parser = argparse.ArgumentParser(prog="sh tests/long.sh", description="Runs what is too long for sh tests/run.sh.")
    parser.add_argument("stages", nargs="*", metavar="STAGE", help="which, of " + ", ".join(STAGES) + "; all unless said")
    parser.add_argument("--list", action="store_true", help="say what there is, and what has passed here")
    parser.add_argument("--again", action="store_true", help="run also what has passed on this tree")
    parser.add_argument("--random", type=int, metavar="N", help="so many random robots, and a thirtieth of it scenes for each test robot")
    options = parser.parse_args()
    for stage in options.stages:
        if stage not in STAGES:
            print(f"long.sh: there is no stage '{stage}'; there are {', '.join(STAGES)}", file=sys.stderr)
            return 2
    if options.random:
        STAGES["random"].environment.update(DALEMBERT_RANDOM_ROBOTS=str(options.random),
                                            DALEMBERT_RANDOM_SCENES=str(max(1, options.random // 30)))
    if options.list:
        for name, stage in STAGES.items():
            print(f"{name:8} {stage.what}: {said_of(name)}")
        return 0
    if subprocess.run(SETUP, cwd=ROOT).returncode != 0:
        return 1
    LOGS.mkdir(parents=True, exist_ok=True)
    failed = []
    wanted = options.stages or list(STAGES)
    for number, stage in enumerate(wanted, 1):
        head, log = f"== [{number}/{len(wanted)}] {stage}: {STAGES[stage].what}", LOGS / f"{stage}.log"
        if passed_here(stage) and not options.again:
            print(f"{head}; {said_of(stage)}")
            continue
        print(f"{head}; {said_of(stage)}; begun {datetime.datetime.now():%H:%M}; build/long/{stage}.log", flush=True)
        if not run_stage(stage, log, options.again):
            failed.append(stage)
    if failed:
        print("failed: " + ", ".join(failed))
    return 1 if failed else 0


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        print("\nstopped; the same command goes on with it")
        sys.exit(130)
