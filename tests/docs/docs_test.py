"""Runs the commands of README.md and docs/*.md, in order, from the top of the project.

usage: docs_test.py PROJECT BUILD [--update]    BUILD takes the place of build/release

```sh       commands that must succeed
```console  after each line "$ command" what it prints, word for word; its exit status may be anything. With --update what
            stands there is replaced by what is printed, and the other commands are not run.

Relative links must lead to a file. Commands that would build everything again are run by whoever started this test; they are
listed here with who that is.
"""

import pathlib
import re
import shutil
import subprocess
import sys

RUN_ELSEWHERE = {
    "sh examples/mahru/run.sh": "same steps, other build folder: test mahru_controller_fixed",
    "sh examples/mahru/run.sh --base floating": "same steps, other build folder: test mahru_controller_floating",
    "sh tests/run.sh": "runs this test; called by .ci/run",
    "cmake --preset release": "tests/run.sh",
    "cmake --build --preset release": "tests/run.sh",
    "cmake --build --preset release --target regenerate": "writes what the tests golden.mahru and docs compare",
    "sh tests/fuzz/run.sh": "builds everything with another compiler and runs for minutes; ctest -R fuzz_corpus replays what it has found",
    "sh tests/fuzz/run.sh scene 10000000": "the same",
    "build/release/bin/dalembert report examples/mahru/mahru.urdf -o build/try/report":
        "minutes of compiling; the test report makes one of a smaller robot",
    "sh cmake/format.sh": "changes the sources",
    "cmake --workflow --preset dev": "builds everything again, with sanitizers",
    "cmake --workflow --preset tsan": "builds everything again, with sanitizers",
    "sh cmake/setup.sh build test matrix": "installs compilers that nothing else needs",
    "python3 tests/benchmarks/sweep.py": "four minutes of measuring; the test benchmark_sweep runs a slice of it",
    "python3 tests/matrix/run.py": "three quarters of an hour; a slice of it is the test matrix.slice",
}

project, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
update = "--update" in sys.argv[3:]


def output_of(script):
    """Exit status and output of a script, in which build/release stands for BUILD."""
    script = script.replace("build/release", f"'{build}'")
    result = subprocess.run(["sh", "-e", "-c", script], cwd=project, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return result.returncode, result.stdout


def blocks(text, language):
    return re.finditer(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def run_commands(page, text):
    """Runs the page's ```sh blocks; returns how many there are."""
    count = 0
    for block in blocks(text, "sh"):
        count += 1
        lines = [re.sub(r"\s+# .*", "", line) for line in block[1].splitlines()]
        script = "\n".join(line for line in lines if line not in RUN_ELSEWHERE)
        if not script:
            continue
        print(script, flush=True)
        status, output = output_of(script)
        print(output[-2000:], flush=True)
        if status != 0:
            sys.exit(f"{page}: exit status {status}")
    return count


def with_output(block):
    """The ```console block as it should read."""
    text = "```console\n"
    for line in block[1].splitlines():
        if line.startswith("$ "):
            text += f"{line}\n{output_of(line[2:])[1]}"
    return text + "```"


def check_links(page, text):
    for link in re.findall(r"\]\((?!https?:|#)([^)#]+)[^)]*\)", text):
        if not (page.parent / link).exists():
            sys.exit(f"{page}: {link} does not exist")


shutil.rmtree(project / "build" / "try", ignore_errors=True)
found = 0
for page in [project / "README.md", *sorted((project / "docs").glob("*.md"))]:
    text = page.read_text(encoding="utf-8")
    if not update:
        found += run_commands(page, text)
        check_links(page, text)
    printed = re.sub(r"^```console\n(.*?)^```$", with_output, text, flags=re.MULTILINE | re.DOTALL)
    if printed != text and not update:
        sys.exit(f"{page}: an example's output is not what is printed today:\n{printed}\n"
                 "If the change is meant: cmake --build --preset release --target regenerate")
    if printed != text:
        page.write_text(printed, encoding="utf-8")
if found == 0 and not update:
    sys.exit("no commands found")
