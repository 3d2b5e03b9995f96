"""mutation_test.py DALEMBERT PROJECT EIGEN WORK COMPILER PRECOMPILED   The emitted self-test finds wrong code.

Generates three robots that between them use both forms and both bases, and spoils their dynamics.cpp in 6 ways, in the long run 21: the
sign of a constant, an index, a term left out. A mutation counts when results change by more than 1e-9 of the largest at states that are
not the self-test's; each that counts must fail the self-test, at an output that has changed. Then g++ 12.2's defect: constants
of MAHRU are changed as it changes them; and where this compiler and processor show it, by the defect itself, in code that copies
tables of constants as emitted code used to.
"""
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys

DALEMBERT, PROJECT, EIGEN, WORK, COMPILER, PRECOMPILED = sys.argv[1:7]
PROJECT, WORK = pathlib.Path(PROJECT), pathlib.Path(WORK)
WORK.mkdir(parents=True, exist_ok=True)
INCLUDE = ["-std=c++17", f"-I{WORK}", f"-I{PROJECT}/runtime/include", "-isystem", EIGEN]
PLAIN = ["-O0", "-fPIC", *PRECOMPILED.split()]
EACH = 7 if os.environ.get("DALEMBERT_LONG_TESTS") else 1  # mutations of each kind
AVX512 = ["-O2", "-march=skylake-avx512"]

MAIN = """
#include <cmath>
#include <cstdio>
#include <dalembert/self_test.hpp>
#include <memory>
#include <vector>
#include "%(name)s/dynamics.hpp"
#include "%(name)s/self_test.hpp"
int main() {
  using namespace %(name)s;
  const auto workspace = std::make_unique<Workspace>();
  for (int s = 0; s < 3; ++s) {
    std::vector<Scalar> q(nq), v(nv);
    for (int i = 0; i < nq; ++i) q[i] = Scalar(std::sin(0.3 + 2.1 * i + 5 * s));
    for (int i = 0; i < nv; ++i) v[i] = Scalar(2 * std::cos(1.3 + 1.7 * i + 3 * s));
    if (nq > nv) for (int i = 3; i < 7; ++i) q[i] = Scalar(i %% 2 ? 0.7 : 0.1);
    evaluate(q.data(), v.data(), *workspace);
%(print)s
  }
  SelfTestReport report;
  const bool passed = self_test(&report);
  char text[512];
  dalembert::describe(report, text, sizeof text);
  std::printf("%%s %%s\\n%%s\\n", passed ? "passed" : "failed", report.output, text);
}
"""


def run(*words):
    return subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


class Robot:
    """A generated robot: what is compiled once, and the text that is spoilt."""

    def __init__(self, urdf, name, *options):
        self.name, self.folder = name, WORK / name
        subprocess.run([DALEMBERT, "generate", PROJECT / urdf, "--name", name, "-o", self.folder, "--parallel", "serial", *options],
                       check=True)
        self.text = (self.folder / "dynamics.cpp").read_text()
        header = (self.folder / "dynamics.hpp").read_text()
        self.outputs = re.findall(r"^inline Result<.*> (\w+)\(const Workspace", header, re.MULTILINE)
        prints = "".join(f'    for (const Scalar x : workspace->{o}) std::printf("{o} %.17g\\n", double(x));\n' for o in self.outputs)
        (WORK / f"{name}_main.cpp").write_text(MAIN % {"name": name, "print": prints})
        self.objects = []
        for source in (WORK / f"{name}_main.cpp", self.folder / "self_test.cpp"):
            self.objects.append(WORK / f"{name}_{source.stem}.o")
            subprocess.run([COMPILER, *INCLUDE, *PLAIN, "-c", source, "-o", self.objects[-1]], check=True)
        self.right = self.results("right", self.text)
        assert self.right and self.right["verdict"] == "passed", f"{name}: right code fails its self-test: {self.right}"

    def results(self, label, text, flags=PLAIN):
        """What the program prints with this dynamics.cpp; None when it does not compile or run."""
        source = WORK / f"{self.name}_{label}.cpp"
        source.write_text(text.replace('#include "dynamics.hpp"', f'#include "{self.name}/dynamics.hpp"'))
        program = source.with_suffix("")
        if run(COMPILER, *INCLUDE, *flags, source, *self.objects, "-o", program).returncode != 0:
            return None
        ran = run("timeout", "20", program)
        if ran.returncode != 0:
            return None
        lines = ran.stdout.splitlines()
        verdict, output = (lines[-2] + " ").split(" ", 1)
        values = {o: [float(line.split()[1]) for line in lines if line.startswith(o + " ")] for o in self.outputs}
        return {"verdict": verdict, "output": output.strip(), "report": lines[-1], "values": values}

    def changed(self, wrong):
        """The outputs that differ by more than rounding."""
        names = []
        for output, right in self.right["values"].items():
            largest = max(map(abs, right))
            if any(not abs(a - b) <= 1e-9 * largest for a, b in zip(right, wrong["values"][output])):
                names.append(output)
        return names


def constants(text):
    """Every constant but 0, its sign turned."""
    for match in re.finditer(r"(?<![\w.])-?\d+\.\d+(e-?\d+)?(?![\w.]|f?[\w])f?", text):
        if float(match[0].rstrip("f")) != 0:
            yield match, match[0][1:] if match[0][0] == "-" else "-" + match[0]


def indices(text):
    """Every constant index but 0, one less; declarations aside."""
    for match in re.finditer(r"\[([1-9]\d*)\](?!\s*=\s*\{|\[\d+\] = \{)", text):
        line = text[text.rfind("\n", 0, match.start()) + 1:match.start()]
        if not re.match(r"\s*(static |alignas\(\d+\) |constexpr |const )*(Scalar|int|V)\b", line) or " = " in line:
            yield match, f"[{int(match[1]) - 1}]"


def terms(text):
    """Every term of a sum but the first, left out."""
    for match in re.finditer(r" [+-] (?!\d)[\w.]+(\[\w+\])*( \* [\w.]+(\[\w+\])*)*(?=;| [+-] )", text):
        if not text[text.rfind("\n", 0, match.start()) + 1:].lstrip().startswith(("for", "//")):
            yield match, ""


def code(text):
    """The text with its comments blanked, so that nothing in them is found."""
    return re.sub(r"//[^\n]*", lambda m: " " * len(m[0]), text)


def mutants(robot, kind):
    """Texts with one mutation each, from all over the file, and what was changed."""
    found = list(kind(code(robot.text)))
    order = sorted(range(len(found)), key=lambda i: (i * 0.6180339887) % 1)
    for i in order:
        match, instead = found[i]
        line = robot.text.count("\n", 0, match.start()) + 1
        yield (robot.text[:match.start()] + instead + robot.text[match.end():],
               f"{robot.name} line {line}: '{match[0].strip()}' becomes '{instead.strip()}'")


def must_fail(robot, wrong, what):
    changed = robot.changed(wrong)
    assert wrong["verdict"] == "failed", f"NOT FOUND: {what}; changed are {changed}"
    assert wrong["output"] in changed, f"{what}: the report names {wrong['output']}, changed are {changed}"
    print(f"found: {what}: {wrong['report']}", flush=True)


def find(pool, robots, kind):
    """Mutations of the kind that count, by turns of each robot."""
    sources = [mutants(robot, kind) for robot in robots]
    counted = tried = 0
    while counted < EACH:
        batch = [(robot, *next(source)) for robot, source in zip(robots, sources)]
        results = pool.map(lambda job: job[1][0].results(f"{kind.__name__}_{job[0]}", job[1][1]), enumerate(batch, tried))
        for (robot, _, what), wrong in zip(batch, results):
            tried += 1
            if counted < EACH and wrong and robot.changed(wrong):
                counted += 1
                must_fail(robot, wrong, what)
    print(f"{kind.__name__}: {counted} of {tried} tried count", flush=True)


TABLE = re.compile(r"alignas\(64\) constexpr Scalar (\w+)\[(\d+)\] = \{([^}]*)\};")


def concerned(numbers):
    """Places of the groups {a, a, 0, 0}."""
    return [i for i in range(0, len(numbers) - 3, 4)
            if float(numbers[i]) != 0 and numbers[i] == numbers[i + 1] and float(numbers[i + 2]) == float(numbers[i + 3]) == 0]


def as_by_the_defect(match):
    numbers = match[3].replace(",", " ").split()
    for i in concerned(numbers):
        numbers[i + 2] = numbers[i + 3] = numbers[i]
    return f"alignas(64) constexpr Scalar {match[1]}[{match[2]}] = {{{', '.join(numbers)}}};"


def with_copies(text):
    """The tables that the defect would spoil are copied before they are used."""
    copies = []

    def copied(match):
        if not concerned(match[3].replace(",", " ").split()):
            return match[0]
        copies.append(f"  copy_{match[1]}({match[1]});\n")
        return (match[0].replace(match[1], match[1] + "_constant", 1) + f"""
alignas(64) Scalar {match[1]}[{match[2]}];
__attribute__((noipa)) void copy_{match[1]}(Scalar* to) {{
  std::memcpy(to, {match[1]}_constant, sizeof {match[1]}_constant);
}}""")
    text, functions = re.subn(r"(\nvoid evaluate\([^{]*\{\n)", lambda m: m[1] + "".join(copies), TABLE.sub(copied, text))
    assert copies and functions == 1, f"nothing is copied: {len(copies)} tables, {functions} places"
    return text


def shows_the_defect():
    source = WORK / "defect.cpp"
    source.write_text("""
#include <cstring>
alignas(64) static constexpr double table[24] = {0, 0, 0, 0, 0, 0, -0.794, -0.794, 0, 0, 0, 0, 0.03, 0.03, 0.011, 0.011,
                                                 0.042, 0.042, 0, 0, -0.112, -0.112, 0, 0};
__attribute__((noinline)) void copy(double* to) { std::memcpy(to, table, sizeof table); }
int main() { double to[24]; copy(to); return to[18] != 0; }
""")
    if "avx512vl" not in pathlib.Path("/proc/cpuinfo").read_text():
        return "the processor has no AVX-512"
    if run(COMPILER, *AVX512, source, "-o", WORK / "defect").returncode != 0:
        return "the compiler has no AVX-512"
    return "" if run(WORK / "defect").returncode == 1 else "the compiler is without the defect"


def main():
    robots = [Robot("tests/robots/prismatic_mix.urdf", "straight_fixed", "--base", "fixed", "--form", "straight"),
              Robot("tests/robots/prismatic_mix.urdf", "straight_floating", "--base", "floating", "--form", "straight"),
              Robot("tests/robots/quadruped.urdf", "rolled_floating", "--base", "floating", "--form", "rolled")]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        for kind in (constants, indices, terms):
            find(pool, robots, kind)
    mahru = Robot("examples/mahru/mahru.urdf", "mahru", "--form", "rolled", "--outputs", "mass_matrix,gravity")
    wrong = mahru.results("as_by_the_defect", TABLE.sub(as_by_the_defect, mahru.text))
    must_fail(mahru, wrong, "tables as g++ 12.2's defect leaves them")
    copied = with_copies(mahru.text)
    right = mahru.results("copies", copied)  # or what fails below might fail for its copies
    assert right and right["verdict"] == "passed", f"code that copies its tables fails when compiled with -O0: {right}"
    absent = shows_the_defect()
    if absent:
        print(f"not run: the defect itself; {absent}")
        return
    right = mahru.results("avx512", mahru.text, AVX512)
    assert right["verdict"] == "passed", f"emitted code fails with {AVX512}: {right['report']}"
    must_fail(mahru, mahru.results("copies", copied, AVX512), "g++ 12.2's defect, the tables copied")


main()
