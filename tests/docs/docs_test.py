"""Runs the commands of README.md, docs/*.md and the pages beside tests and examples, in order, from the top of the project.

usage: docs_test.py PROJECT BUILD [--update]    BUILD takes the place of build/release

```sh       commands that must succeed
```console  after each line "$ command" what it prints, word for word; its exit status may be anything. With --update what
            stands there is replaced by what is printed, and the other commands are not run.

```cpp behind a line "<!-- file PATH -->" is written to PATH, for the commands behind it to compile; behind a line
"<!-- from PATH NAME -->" it is what stands in PATH between "// [NAME]" and "// [end of NAME]" (updated by --update).

Relative links must lead to a file. No page says a word of words.txt, nor the hash of a commit; nor do help and messages. Commands that would build everything again are run by whoever started this test; they are
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
    "sh examples/mahru/run.sh --stand": "same steps, other build folder: test mahru_standing",
    "sh examples/mahru/run.sh --walk": "same steps, other build folder: test mahru_walking",
    "build/release/bin/dalembert calibrate": "compiles for a minute: test calibrate of the long run",
    "build/release/bin/dalembert info examples/mahru/mahru.urdf --threads 2 --calibrated": "the same",
    "sh tests/run.sh": "runs this test; called by .ci/run",
    "cmake --preset release": "tests/long.sh; tests/run.sh has the same but for the compiler",
    "cmake --build --preset release": "tests/long.sh, the same",
    "cmake --build --preset release --target regenerate": "writes what the tests golden.mahru and docs compare",
    "sh tests/long.sh": "everything that is too long for tests/run.sh",
    "sh tests/fuzz/run.sh": "builds everything with another compiler and runs for minutes; ctest -R fuzz_corpus replays what it has found",
    "sh tests/fuzz/run.sh scene 10000000": "the same",
    "build/release/bin/dalembert report examples/mahru/mahru.urdf -o build/try/report":
        "minutes of compiling; the test report makes one of a smaller robot",
    "build/example/bin/dalembert report examples/mahru/mahru.urdf -o build/try/report": "the same",
    "sh cmake/format.sh": "changes the sources",
    "sh cmake/setup.sh build": "tests/run.sh",
    "cmake --preset example && cmake --build --preset example --target dalembert": "builds again what tests/run.sh has built",
    "cmake --workflow --preset dev": "builds everything again, with sanitizers",
    "cmake --workflow --preset tsan": "builds everything again, with sanitizers",
    "sh cmake/setup.sh build test matrix": "installs compilers that nothing else needs",
    "python3 tests/benchmarks/sweep.py": "four minutes of measuring; the test benchmark_sweep runs a slice of it",
    "/usr/bin/python3 tests/python/fuzz.py --cases 10000": "minutes under sanitizers; a slice of it is in the test python_calls_test",
    "cmake --preset release && cmake --build --preset release": "tests/long.sh, the same",
    "(cd build/release && cpack)": "the test packaging (.deb)",
    "cmake --build --preset release --target farm": "tests/run.sh",
    "mpirun -np 2 build/release/bin/farm sweep --states 10000000 --out build/try/sweep.h5": "gigabytes; the test farm computes fewer",
    "build/release/bin/farm record --out build/try/recording.h5": "the test farm, where there is MPI",
    "mpirun -np 2 build/release/bin/farm identify --candidates 100000 --recording build/try/recording.h5 --out build/try/loads.h5":
        "the same",
    "/usr/bin/python3 examples/farm/read.py build/try/loads.h5": "the same",
    "python3 tests/matrix/run.py": "hours; a slice of it is the test matrix.slice",
}

project, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
update = "--update" in sys.argv[3:]


def output_of(script):
    """Exit status and output of a script, in which build/release stands for BUILD."""
    script = re.sub(r"build/(release|example)(?![\w-])", f"'{build}'", script)
    result = subprocess.run(["sh", "-e", "-c", script], cwd=project, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    return result.returncode, result.stdout


def blocks(text, language):
    return re.finditer(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


def run_commands(page, text):
    """Writes the page's files and runs its ```sh blocks; returns how many of the latter there are."""
    count = 0
    for block in re.finditer(r"^(?:<!-- file (\S+) -->\n```cpp|```sh)\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
        if block[1]:
            path = project / block[1]
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(block[2], encoding="utf-8")
            continue
        count += 1
        lines = [re.sub(r"\s+# .*", "", line) for line in block[2].splitlines()]
        script = "\n".join(line for line in lines if line not in RUN_ELSEWHERE)
        if not script:
            continue
        print(script, flush=True)
        status, output = output_of(script)
        print(output[-2000:], flush=True)
        if status != 0:
            sys.exit(f"{page}: exit status {status}")
    return count


def with_listing(block):
    """The ```cpp block as it stands in its source."""
    source = (project / block[1]).read_text(encoding="utf-8")
    part = re.search(rf"^ *// \[{block[2]}\]\n(.*?)^ *// \[end of {block[2]}\]$", source, re.MULTILINE | re.DOTALL)
    if not part:
        sys.exit(f"{block[1]}: there is no part [{block[2]}]")
    return f"<!-- from {block[1]} {block[2]} -->\n```cpp\n{part[1]}```"


def check_words(where, text, words):
    for number, line in enumerate(text.splitlines(), 1):
        for word, instead in words:
            if re.search(word, line, re.IGNORECASE):
                sys.exit(f"{where}:{number}: '{word}' is not what we say, but {instead}: {line.strip()}")


def check_hashes(page, text):
    """A diary's: seven to twelve hexadecimal digits with letters and figures among them, as git prints commits."""
    for match in re.finditer(r"(?<![\w.#/-])(?=[0-9a-f]*[a-f])(?=[0-9a-f]*[0-9])[0-9a-f]{7,12}(?![\w-]|\.\w)", text):
        sys.exit(f"{page}: '{match[0]}' looks like a commit; say what holds now")


def messages():
    """What the generator and the build can say: the literals of its sources, and CMake's texts."""
    for path in sorted((project / "generator").rglob("*.cpp")):
        for line in path.read_text(encoding="utf-8").splitlines():
            if not line.lstrip().startswith("#include"):
                yield path, "\n".join(re.findall(r'"((?:[^"\\]|\\.)*)"', line))
    for path in [*sorted((project / "cmake").glob("*.cmake")), *sorted((project / "templates").rglob("*.*"))]:
        yield path, path.read_text(encoding="utf-8")


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
words = [line.split("\t") for line in (project / "tests/docs/words.txt").read_text(encoding="utf-8").splitlines()
         if line and not line.startswith("#")]
found = 0
pages = [project / "README.md", *sorted((project / "docs").glob("*.md")), *sorted((project / "examples").rglob("*.md")),
         *sorted((project / "tests").rglob("*.md"))]
if not update:
    for command in ["", *(f" {name}" for name in ("info", "generate", "eval", "check", "report"))]:
        check_words(f"dalembert{command} --help", output_of(f"build/release/bin/dalembert{command} --help")[1], words)
    for path, text in messages():
        check_words(path, text, words)
for page in pages:
    text = page.read_text(encoding="utf-8")
    if not update:
        check_words(page, text, words)
        check_hashes(page, text)
        found += run_commands(page, text)
        check_links(page, text)
    printed = re.sub(r"^```console\n(.*?)^```$", with_output, text, flags=re.MULTILINE | re.DOTALL)
    printed = re.sub(r"^<!-- from (\S+) (.+?) -->\n```cpp\n.*?^```$", with_listing, printed, flags=re.MULTILINE | re.DOTALL)
    if printed != text and not update:
        sys.exit(f"{page}: an example's output is not what is printed today:\n{printed}\n"
                 "If the change is meant: cmake --build --preset release --target regenerate")
    if printed != text:
        page.write_text(printed, encoding="utf-8")
if found == 0 and not update:
    sys.exit("no commands found")
