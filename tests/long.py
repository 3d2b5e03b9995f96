"""Everything that takes hours, by one command that may be stopped and gone on with: see tests/long.sh.

A stage that has passed leaves a note in build/long, with what it was run on: a digest of the files that it is about. Exit status: 0
all stages asked for have passed, 1 one has failed, 2 a stage is asked for that there is none of.
"""
import argparse
import datetime
import hashlib
import json
import os
import pathlib
import platform
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
NOTES = ROOT / "build" / "long"
README = ROOT / "tests" / "README.md"
JOBS = str(os.cpu_count())


def workflow(preset):
    return [["cmake", "--preset", preset], ["cmake", "--build", "--preset", preset, "-j", JOBS],
            ["ctest", "--preset", preset, "-j", JOBS]]


def build_release(*targets):
    return [["cmake", "--preset", "release"], ["cmake", "--build", "--preset", "release", "-j", JOBS, "--target", *targets]]


# name: what it is, its commands, and more of their environment.
STAGES = {
    "release": ("every test, those of benchmarks too", workflow("release"), {}),
    "dev": ("the tests of sh tests/run.sh with the address and undefined-behaviour sanitizers", workflow("dev"), {}),
    "tsan": ("what runs on threads, with the thread sanitizer", workflow("tsan"), {}),
    "matrix": ("emitted code in many compilers", [*build_release("bin/dalembert"), ["python3", "tests/matrix/run.py"]], {}),
    "fuzz": ("URDFs and scenes, a million each", [["sh", "tests/fuzz/run.sh", "all", "1000000"]], {}),
    "random": ("scenes and robots drawn at random, interpreted; every quantity alone of large robots",
               [*build_release("random_scenes_test", "algorithm_test", "constraints_test"),
                ["ctest", "--preset", "release", "-j", JOBS, "-R", "^(RandomScenes|RandomRobots|Algorithm|Constraints)[.]"]],
               {"DALEMBERT_RANDOM_SCENES": "300", "DALEMBERT_RANDOM_ROBOTS": "10000", "DALEMBERT_LARGE_ROBOTS": "1"}),
    "compiled": ("robots and scenes drawn at random, compiled",
                 [*build_release("bin/dalembert"), ["python3", "tests/random/compiled.py", "build/release/bin/dalembert"]], {}),
}


def state_of_tree(stage):
    """A digest of the files that the stage is about, committed or not: pages are the release's alone."""
    files = [".", ":!tests/README.md"] + ([] if stage == "release" else [":!docs", ":!*.md"])
    digest = hashlib.sha256()
    for words in (["ls-files", "--stage"], ["diff", "HEAD"], ["status", "--porcelain"]):
        digest.update(subprocess.run(["git", *words, "--", *files], cwd=ROOT, capture_output=True, check=True).stdout)
    return digest.hexdigest()[:16]


def note_of(stage):
    path = NOTES / f"{stage}.json"
    return json.loads(path.read_text()) if path.exists() else {}


def in_words(seconds):
    return f"{seconds / 60:.0f} min" if seconds >= 90 else f"{seconds:.0f} s"


def run(stage, log):
    """Whether all commands succeed; their output goes to the log, its last line to the screen now and then."""
    _, commands, more = STAGES[stage]
    for command in commands:
        print("   $ " + " ".join(command), flush=True)
        with open(log, "ab") as out:
            process = subprocess.Popen(command, cwd=ROOT, stdout=out, stderr=subprocess.STDOUT, env={**os.environ, **more})
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
        if process.returncode != 0:
            return False
    return True


def result_in(log):
    """What the tools say in the end, in few words."""
    text = log.read_text(errors="replace")
    found = [f"{m[1]} tests, {m[0]} failed" for m in re.findall(r"(\d+) tests? failed out of (\d+)", text)]
    found += [f"{m} cells" for m in re.findall(r"(\d+ cells: \d+ right, \d+ wrong)", text)]
    found += [f"{m} runs" for m in re.findall(r"stat::number_of_executed_units:\s+(\d+)", text)]
    return "; ".join(dict.fromkeys(found[-2:]))


def write_table():
    rows = ["| stage | what | came of it | took | on |", "|---|---|---|---:|---|"]
    for stage, (what, _, _) in STAGES.items():
        note = note_of(stage)
        if note:
            rows.append(f"| `{stage}` | {what} | {note['result'] or ('passed' if note['passed'] else 'failed')} | "
                        f"{in_words(note['seconds'])} | {note['date']}, {note['machine']} |")
    table = "<!-- long -->\n" + "\n".join(rows) + "\n<!-- /long -->"
    text = README.read_text()
    README.write_text(re.sub(r"<!-- long -->.*?<!-- /long -->", lambda _: table, text, flags=re.S))


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
        STAGES["random"][2].update(DALEMBERT_RANDOM_ROBOTS=str(options.random),
                                   DALEMBERT_RANDOM_SCENES=str(max(1, options.random // 30)))
    if options.list:
        for stage, (what, _, _) in STAGES.items():
            note = note_of(stage)
            state = "not run here" if not note else ("passed" if note["passed"] else "failed") + \
                ("" if note["tree"] == state_of_tree(stage) else " on another tree") + f", {in_words(note['seconds'])}"
            print(f"{stage:8} {what}: {state}")
        return 0
    NOTES.mkdir(parents=True, exist_ok=True)
    failed = []
    wanted = options.stages or list(STAGES)
    for number, stage in enumerate(wanted, 1):
        note, log = note_of(stage), NOTES / f"{stage}.log"
        head = f"== [{number}/{len(wanted)}] {stage}: {STAGES[stage][0]}"
        tree = state_of_tree(stage)
        if note and note["passed"] and note["tree"] == tree and not options.again:
            print(f"{head}; passed on this tree already ({in_words(note['seconds'])})")
            continue
        last = f"; {in_words(note['seconds'])} the last time" if note else ""
        print(f"{head}; begun {datetime.datetime.now():%H:%M}{last}; build/long/{stage}.log", flush=True)
        log.write_bytes(b"")
        begun = time.time()
        passed = run(stage, log)
        note = {"passed": passed, "tree": tree, "seconds": time.time() - begun, "result": result_in(log),
                "date": f"{datetime.date.today()}", "machine": f"{platform.machine()}, {JOBS} cores"}
        (NOTES / f"{stage}.json").write_text(json.dumps(note))
        print(f"   {'passed' if passed else 'FAILED'} after {in_words(note['seconds'])}: {note['result']}", flush=True)
        write_table()
        if not passed:
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
