#!/usr/bin/env python3
"""Times every way to compute a quantity (straight or rolled, articulated bodies or M's factors) against what `auto` chooses, and fits
the constants of the estimate by which it chooses (generator/backend/estimate.cpp).

    python3 tests/benchmarks/forms.py [--robots A,B] [--quantities M,fd] [--targets native,avx2,sse2] [--save FILE]
    python3 tests/benchmarks/forms.py --against TREE    what another checkout chooses (its release build made) beside what this one does
    python3 tests/benchmarks/forms.py --fit FILE        from what --save has kept: constants that choose better than the committed
                                                        ones; prints a row of them per width of registers

Each way of one robot and quantity is a shared object; all of them run in one process, in turn, from three copies each (code beyond
the first-level cache is faster in one copy than in another). Prints medians in ns and chosen / best. Needs the release build.
Runs side by side keep out of each other's folders, though not of each other's time.
"""
import argparse
import concurrent.futures
import json
import math
import pathlib
import random
import re
import shutil
import statistics
import subprocess
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILD = ROOT / "build" / "release"
FOLDER = None  # of this run alone: another may be under way
DATA = "/usr/share/doc/dart/data"
QUANTITIES = {
    "M": "mass_matrix", "C": "coriolis_matrix", "M+C": "mass_matrix,coriolis_matrix", "g": "gravity", "bias": "bias",
    "id": "inverse_dynamics", "fd": "forward_dynamics", "minv": "inverse_mass_matrix",
    "did": "inverse_dynamics_dq,inverse_dynamics_dv", "dfd": "forward_dynamics_dq,forward_dynamics_dv,inverse_mass_matrix",
    "cmm": "momentum_matrix", "com": "center_of_mass,center_of_mass_jacobian", "energy": "kinetic_energy,potential_energy",
    "regressor": "regressor"}
SOLVED = ("fd", "minv", "dfd")
FIXED = ("arm", "six", "scara", "chain", "dual", "hand", "planar", "skew", "pendulum", "double", "gantry", "prism")
SHAPES = ("arm_fingers six_axis six_axis_positioner scara quadruped_8 quadruped_12 dual_arm biped_10 hand_16 WAM KR5 MAHRU Atlas "
          "chain_7 planar_chain_10 skew_chain_10 mirror_pair branch_below_base unequal_limbs grippers quadruped hexapod hand "
          "two_levels_of_branching prismatic_mix continuous_joints humanoid").split()
OTHERS = {"WAM": (f"{DATA}/urdf/wam/wam.urdf", "fixed"), "KR5": (f"{DATA}/urdf/KR5/KR5 sixx R650.urdf", "fixed"),
          "MAHRU": (f"{ROOT}/examples/mahru/mahru.urdf", "floating"),
          "Atlas": (f"{DATA}/sdf/atlas/atlas_v3_no_head.urdf", "floating")}
TARGETS = {"native": "-march=native", "avx512": "-march=x86-64-v4", "avx2": "-march=x86-64-v3", "sse2": "-march=x86-64"}
LANES = {"native": 8, "avx512": 8, "avx2": 4, "sse2": 2}
QUIET = {"check": True, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL, "text": True}
WRAPPER = """#include "r/dynamics.cpp"
extern "C" void form_run(const double* q, const double* v, [[maybe_unused]] const double* more, void* workspace) {
  r::together(q, v, MORE *static_cast<r::Workspace*>(workspace));
}
extern "C" void* form_workspace() { return new r::Workspace(); }
extern "C" int form_nq() { return r::nq; }
extern "C" int form_nv() { return r::nv; }
"""


def robot(name):
    if name in OTHERS:
        return OTHERS[name]
    name, _, base = name.partition(":")
    if name.endswith(".urdf"):
        return name, base or "floating"
    return str(ROOT / "tests" / "robots" / f"{name}.urdf"), base or ("fixed" if name.startswith(FIXED) else "floating")


def scene(name, quantity, way):
    urdf, base = robot(name)
    form, solver = way
    options = ["--base", base, "--outputs", "[]", "--functions", "together=" + QUANTITIES[quantity], "--parallel", "serial"]
    return [urdf, *options, *(["--form", form] if form else []), *(["--forward_dynamics", solver] if solver else [])]


def label(way):
    form, solver = way
    return (form or "auto") + (" by " + solver if solver else "")


def compiled(name, target, tree, scene):
    """The shared object of a scene's function `together` by a checkout's generator and runtime."""
    folder = FOLDER / f"{name}_{target}{'' if tree == ROOT else '_other'}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    subprocess.run([tree / "build" / "release" / "bin" / "dalembert", "generate", *scene, "--name", "r", "-o", folder / "r"], **QUIET)
    more = "more, " if "const Scalar* v, const Scalar* " in (folder / "r" / "dynamics.hpp").read_text() else ""
    (folder / "code.cpp").write_text(WRAPPER)
    subprocess.run(["c++", "-O3", *TARGETS[target].split(), "-std=c++17", "-shared", "-fPIC", f"-DMORE={more}", "-I", folder,
                    "-I", tree / "runtime" / "include", "-isystem", "/usr/include/eigen3", folder / "code.cpp", "-o", folder / "code.so"],
                   check=True)
    return folder / "code.so"


def built(name, quantity, way, target, tree=ROOT):
    """The shared object of one way by a checkout's generator and runtime, what its estimate is made of, and the plan."""
    own = scene(name, quantity, way)
    code = compiled(f"{re.sub('[:/]', '_', name)}/{quantity}/{label(way).replace(' ', '_')}", target, tree, own)
    dalembert = tree / "build" / "release" / "bin" / "dalembert"
    told = json.loads(subprocess.run([dalembert, "info", "--json", *own], **QUIET).stdout)
    return code, told.get("estimates", {}).get(f"together {LANES[target]}"), told.get("plan", {}).get("together", [None])[0]


def timed(objects, rounds, prefix):
    driver = FOLDER / "driver"
    if not driver.exists():
        subprocess.run(["c++", "-O2", "-std=c++17", pathlib.Path(__file__).with_name("forms_driver.cpp"), "-o", driver, "-ldl"], check=True)
    times = [[] for _ in objects]
    for _ in range(3):
        copies = [shutil.copy(code, FOLDER / f"copy_{i}.so") for i, code in enumerate(objects)]
        answer = subprocess.run([*prefix, driver, str(rounds), *copies], check=True, stdout=subprocess.PIPE, text=True).stdout
        for row, text in zip(times, answer.split()):
            row.append(float(text))
    return [statistics.median(row) for row in times]


def measure(options):
    kept = json.loads(pathlib.Path(options.save).read_text()) if options.save and pathlib.Path(options.save).exists() else {}
    worst = 1
    pool = concurrent.futures.ThreadPoolExecutor(options.jobs)
    for target in options.targets.split(","):
        for quantity in options.quantities.split(","):
            for name in options.robots.split(","):
                if f"{name}/{quantity}/{target}" in kept or not pathlib.Path(robot(name)[0]).exists():
                    continue
                solvers = ("articulated_bodies", "factorization") if quantity in SOLVED else ("",)
                ways = [(form, solver) for form in ("straight", "rolled") for solver in solvers] + [("", "")]
                try:
                    made = list(pool.map(lambda way: built(name, quantity, way, target), ways))
                except subprocess.CalledProcessError as error:
                    print(f"{name}/{quantity}/{target}: {error}", flush=True)
                    continue
                times = timed([code for code, _, _ in made], options.rounds, options.prefix.split())
                best = min(times[:-1])
                worst = max(worst, times[-1] / best)
                chosen = made[-1][2]
                print(f"{name + '/' + quantity + '/' + target:34}",
                      " ".join(f"{label(way)} {time:.1f}" for way, time in zip(ways, times)),
                      f"({chosen['form']} by {chosen['solver']}): {times[-1] / best:.2f} of the best", flush=True)
                kept[f"{name}/{quantity}/{target}"] = [[label(way), time, features]
                                                      for way, time, (_, features, _) in zip(ways, times, made)][:-1]
                if options.save:
                    pathlib.Path(options.save).write_text(json.dumps(kept))
    print(f"worst: {worst:.2f}")


def against(options):
    other = pathlib.Path(options.against).resolve()
    pool = concurrent.futures.ThreadPoolExecutor(options.jobs)
    for target in options.targets.split(","):
        for quantity in options.quantities.split(","):
            ratios = []
            for name in options.robots.split(","):
                if not pathlib.Path(robot(name)[0]).exists():
                    continue
                here, there = pool.map(lambda tree: built(name, quantity, ("", ""), target, tree), (ROOT, other))
                new, old = timed([here[0], there[0]], options.rounds, options.prefix.split())
                ratios.append(new / old)
                print(f"{name + '/' + quantity + '/' + target:34} {old:9.1f} {new:9.1f} {new / old:6.3f}", flush=True)
            print(f"{quantity + '/' + target:34} {'median':>9} {'worst':>9} {statistics.median(ratios):6.3f} {max(ratios):6.3f}", flush=True)


def committed():
    """The constants of the estimate, by lanes."""
    text = (ROOT / "generator" / "backend" / "estimate.cpp").read_text()
    rows = re.findall(r"{([^{}]*)},", text[text.index("constexpr Features constants[3]"):])[:3]
    return {lanes: [float(x) for x in row.split(",")] for lanes, row in zip((2, 4, 8), rows)}


def chosen(estimates, names):
    """What `auto` takes on each width of registers (generator/lower.cpp): the cheapest with registers of four, and the other form
    where it gains more than estimates err."""
    first = min(range(len(names)), key=estimates[4 if 4 in estimates else min(estimates)].__getitem__)
    other, most = first, 1.06
    for lanes, own in estimates.items():
        for way, name in enumerate(names):
            if name.split()[0] != names[first].split()[0] and own[first] / own[way] > most:
                other, most = way, own[first] / own[way]
    return {lanes: other if own[other] < own[first] else first for lanes, own in estimates.items()}


class Cases:
    """Times and features of each robot and quantity, by lanes, and how well constants choose among them."""

    def __init__(self, kept):
        self.all = {}
        for case, ways in kept.items():
            names, times, features = zip(*((name, time, list(of.values())) for name, time, of in ways))
            self.all.setdefault(case.rpartition("/")[0], {})[LANES[case.rpartition("/")[2]]] = (names, times, features)

    def losses(self, constants):
        """(what was chosen takes longer, robot and quantity, lanes, what was chosen), and the estimates' squared errors."""
        losses, errors = [], []
        for case, by_lanes in self.all.items():
            estimates = {lanes: [sum(c * x for c, x in zip(constants[lanes], own)) for own in features]
                         for lanes, (_, _, features) in by_lanes.items()}
            names = next(iter(by_lanes.values()))[0]
            for lanes, way in chosen(estimates, names).items():
                times = by_lanes[lanes][1]
                losses.append((times[way] / min(times), times[way] - min(times), case, lanes, names[way]))
                errors += [min(1, math.log(max(e, 0.1) / t) ** 2) for e, t in zip(estimates[lanes], times)]
        return losses, errors

    def cost(self, constants, before):
        """Mean loss beyond 0.01, a fifth of it where it is two nanoseconds; a little for errors, and for leaving `before`, which
        was fitted to other processors too."""
        losses, errors = self.losses(constants)
        moved = [math.log((a + 0.01) / (b + 0.01)) ** 2 for lanes in before for a, b in zip(constants[lanes], before[lanes])]
        return (statistics.mean(max(0, (loss - 1) * (0.2 if more < 2.5 else 1) - 0.01) for loss, more, *_ in losses) +
                0.07 * statistics.mean(errors) + 0.002 * statistics.mean(moved))


def fit(options):
    kept = json.loads(pathlib.Path(options.fit).read_text())
    cases, before = Cases(kept), committed()
    # Of large trees, which are not among these; and what a processor with registers of four fetches, an older one than this.
    names = list(next(iter(kept.values()))[0][2])
    held = {(lanes, names.index(name)) for lanes in before for name in ("tiles", "along")} | {(4, names.index("fetched"))}
    draw = random.Random(1)
    best, cost = before, cases.cost(before, before)
    begin = time.monotonic()
    while time.monotonic() - begin < options.seconds:
        trial = {lanes: list(row) for lanes, row in best.items()}
        for _ in range(draw.randint(1, 4)):
            lanes, i = draw.choice(list(trial)), draw.randrange(len(names))
            if (lanes, i) not in held:
                more = draw.gauss(0, 0.02) if trial[lanes][i] < 0.05 else 0
                trial[lanes][i] = max(0, trial[lanes][i] * math.exp(draw.gauss(0, 0.12)) + more)
        if (own := cases.cost(trial, before)) < cost:
            best, cost = trial, own
    losses, _ = cases.losses(best)
    for lanes, row in best.items():
        own = [loss for loss in losses if loss[3] == lanes]
        if own:
            print("    {" + ", ".join(f"{x:.3g}" for x in row) + f"}},  // {lanes}")
            print(f"{len(own)} cases, {sum(x[0] <= 1.03 for x in own)} within 1.03 of the best")
            for loss, more, case, _, name in sorted(own, reverse=True):
                if loss > 1.03:
                    print(f"    {case}: {name} is {loss:.2f} of the best, by {more:.0f} ns")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", default=",".join(SHAPES), help="of tests/robots, NAME or NAME:fixed or NAME:floating, " + ", ".join(OTHERS) + ", and files: FILE.urdf or FILE.urdf:fixed")
    parser.add_argument("--quantities", default="M,M+C,bias,fd,minv,id,g,dfd,cmm,com")
    parser.add_argument("--targets", default="native,avx2,sse2", help="of " + ", ".join(TARGETS))
    parser.add_argument("--rounds", type=int, default=51)
    parser.add_argument("--jobs", type=int, default=2, help="compilers at a time")
    parser.add_argument("--prefix", default="", help="of the command that times: 'taskset -c 1'")
    parser.add_argument("--save", help="a JSON file of times and features; what it has is not measured again")
    parser.add_argument("--against", metavar="TREE", help="another checkout; prints robot/quantity/target, ns there, ns here, here / there")
    parser.add_argument("--fit", metavar="FILE")
    parser.add_argument("--seconds", type=float, default=100, help="to look for better constants; 0: how the committed ones choose")
    options = parser.parse_args()
    if options.fit:
        return fit(options)
    if not (BUILD / "bin" / "dalembert").exists():
        parser.error(f"there is no generator in {BUILD}: cmake --preset release && cmake --build --preset release")
    global FOLDER
    with tempfile.TemporaryDirectory(prefix="forms.", dir=BUILD) as folder:
        FOLDER = pathlib.Path(folder)
        (against if options.against else measure)(options)


if __name__ == "__main__":
    main()
