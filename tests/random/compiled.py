"""Robots and scenes drawn at random, written, generated, compiled and checked: what interpreted cases (random_scenes_test) leave out.

    python3 tests/random/compiled.py DALEMBERT --cases 500 [--first SEED] [--jobs N] [--work FOLDER] [--native]

A case is a robot (joints of every kind, light and massless links, axes along and askew, equal and unequal branches), a scene
(any of the scene file's keys), a compiler, a level, a target and a width, and of one in four each output by code of its own, too. `dalembert check` has to pass, or to refuse the scene
by name (exit status 2). What fails is made smaller as long as it fails in the same way, and said with its seed and its files.
Cases that have passed are remembered by their seed, as long as what is generated, its self-test, the runtime headers it includes
and the compiler stay the same. Exit status: 0 or 1.
"""

import argparse
import concurrent.futures
import hashlib
import json
import os
import pathlib
import queue
import random
import re
import shutil
import subprocess
import sys

sys.path[:0] = [str(pathlib.Path(__file__).resolve().parents[1] / folder) for folder in (".", "matrix")]
import emitted_code
import passed
import toolchain

# From the joints' own table: what a joint may be turned into.
KINDS = (lambda d: {"helical": d.choice([0.7, -2])}, lambda d: {"universal": [0.36, -0.48, 0.8]}, lambda d: "planar",
         lambda d: "spherical", lambda d: "floating")
OF_CONSTRAINTS = ("constraint_", "delassus", "impact", "constrained_", "inverse_constraint_")
OF_PARTS = ("mass_matrix", "coriolis_matrix", "gravity", "bias", "inverse_dynamics", "momentum_matrix", "center_of_mass_jacobian")
ROWS = {"distance": 1, "pin": 2, "point": 3}  # of loops that may be embedded here
LOOPS = ("point", "weld", "hinge", "cylinder", "planar", "pin", "distance")


class Draw(random.Random):
    def one_in(self, n):
        return self.randrange(n) == 0

    def number(self, size=1.0):
        return 0.0 if self.one_in(3) else round(self.uniform(-size, size), 4)

    def some(self, of, rare):
        return [x for x in of if self.one_in(rare)]


def words(dalembert, option):
    """The values `check --help` lists for an option: no list of quantities stands here."""
    text = subprocess.run([dalembert, "check", "--help"], capture_output=True, text=True, check=True).stdout
    return re.search(rf"--{re.escape(option)}\s+([a-z_, ]+);", text).group(1).split(", ")


def tree_of(d):
    """Parents (link 0 is the root) and kinds of joints: any tree of a few, or a trunk with limbs that resemble each other."""
    if not d.one_in(3):
        count = 1 + d.randrange(8)
        parents = [d.randrange(i + 1) if d.one_in(3) else i for i in range(count)]
        kinds = [d.choice(["revolute"] * 3 + ["continuous", "prismatic", "fixed", "planar", "floating"]) for _ in parents]
        return parents, ["revolute"] + kinds[1:]
    trunk = d.randrange(4)
    parents, kinds = list(range(trunk)), ["revolute"] * trunk
    pattern = [d.choice(["revolute"] * 5 + ["prismatic", "fixed"]) for _ in range(1 + d.randrange(5))]
    for _ in range(2 + d.randrange(5)):
        limb = pattern[:max(1, len(pattern) - d.choice([0, 0, 0, 1, 2]))]  # some are shorter
        if d.one_in(4):
            limb[-1] = "prismatic"
        foot = d.choice([0, trunk, trunk, len(parents)])  # the last: on the limb before it
        for i, kind in enumerate(limb):
            parents.append(foot if i == 0 else len(parents))
            kinds.append(kind)
    return parents, ["revolute"] + kinds[1:]


def robot_of(d):
    """Joints (name, parent, kind, origin, rpy, axis) and links (mass, com, inertia), the root being link 0."""
    parents, kinds = tree_of(d)
    count = len(parents)
    joints = []
    for i in range(count):
        axis = [0.0, 0.0, 0.0]
        axis[d.randrange(3)] = 1.0
        if d.one_in(3):
            axis = [round(d.uniform(-1, 1), 3), round(d.uniform(-1, 1), 3), 1.1]
        joints.append({"name": f"j{i}", "parent": parents[i], "kind": kinds[i],
                       "at": [d.number(0.4) for _ in range(3)], "rpy": [d.number(3), d.number(1.5), d.number(3)], "axis": axis})
    links = []
    for i in range(count + 1):
        tip = all(j["parent"] != i for j in joints)
        massless = not (tip or i == 0) and d.one_in(5)
        mass = 0.01 if d.one_in(6) else round(1 + d.uniform(-0.9, 0.9), 3)
        links.append(None if massless else
                     {"mass": mass, "com": [d.number(0.2) for _ in range(3)], "rpy": [d.number() for _ in range(3)],
                      "inertia": [0.02 * mass, (0.03 + d.uniform(-0.005, 0.005)) * mass, 0.025 * mass]})
    return {"joints": joints, "links": links}


def urdf_of(robot):
    numbers = lambda xs: " ".join(f"{x:.17g}" for x in xs)
    text = '<robot name="random">\n'
    for i, link in enumerate(robot["links"]):
        if link is None:
            text += f'  <link name="l{i}"/>\n'
            continue
        xx, yy, zz = link["inertia"]
        text += (f'  <link name="l{i}"><inertial><origin xyz="{numbers(link["com"])}" rpy="{numbers(link["rpy"])}"/><mass value="{link["mass"]:.17g}"/>'
                 f'<inertia ixx="{xx:.17g}" iyy="{yy:.17g}" izz="{zz:.17g}" ixy="0" ixz="0" iyz="0"/></inertial></link>\n')
    for i, j in enumerate(robot["joints"]):
        limit = '<limit lower="-2" upper="2" effort="9" velocity="9"/>' if j["kind"] in ("revolute", "prismatic") else ""
        axis = f'<axis xyz="{numbers(j["axis"])}"/>' if j["kind"] not in ("fixed", "floating") else ""
        text += (f'  <joint name="{j["name"]}" type="{j["kind"]}"><parent link="l{j["parent"]}"/><child link="l{i + 1}"/>'
                 f'<origin xyz="{numbers(j["at"])}" rpy="{numbers(j["rpy"])}"/>{axis}{limit}</joint>\n')
    return text + "</robot>\n"


def loop_of(d, links, kind):
    loop = {"links": links, "type": kind, "at": [[0.1, 0.2, -0.03, 0.3, 0, 0.1 * d.randrange(2)], [-0.1, 0.05, 0.1, 0.7, 0.2, 0]]}
    if kind == "distance":
        loop["length"] = 0.4
    return loop


def embedded_loop(d, robot):
    """A loop of which some joints are independent, as many as its rows leave; None: the two links drawn have too few between them."""
    above = lambda link: [] if link == 0 else [link] + above(robot["joints"][link - 1]["parent"])
    one, other = d.sample(range(len(robot["links"])), 2)
    between = [robot["joints"][link - 1] for link in {*above(one)} ^ {*above(other)}]
    moving = sorted(j["name"] for j in between if j["kind"] in ("revolute", "continuous", "prismatic"))
    kind = d.choice(sorted(ROWS))
    if len(moving) <= ROWS[kind] or any(j["kind"] in ("planar", "floating") for j in between):
        return None
    loop = loop_of(d, [f"l{one}", f"l{other}"], kind)
    loop.pop("length", None)
    return {**loop, "independent": d.sample(moving, len(moving) - ROWS[kind])}


def part_of(d, single, links, base):
    part = {"joints": sorted(d.sample(single, 1 + d.randrange(min(len(single), 5))))} if d.one_in(2) else \
        {"subtree": d.sample(links, min(len(links), 1 + d.randrange(2)))}
    if base == "floating" and d.one_in(2):
        part["base"] = d.choice([True, False])
    return part


def scene_of(d, robot, quantities):
    moving = [(j["name"], f"l{i + 1}") for i, j in enumerate(robot["joints"])]
    single = [j["name"] for j in robot["joints"] if j["kind"] in ("revolute", "continuous", "prismatic")]
    links = [link for _, link in moving]
    scene = {"base": d.choice(["fixed", "floating"])}
    if d.one_in(2):
        scene["gravity"] = d.choice(["none", "run_time", [0.7, -1.3, -9.81]])
    if d.one_in(6):
        scene["rates_zero"] = True
    if d.one_in(3):
        scene["coriolis"] = "christoffel"
    if d.one_in(3):
        scene["forward_dynamics"] = d.choice(["factorization", "articulated_bodies"])
    if d.one_in(5):
        scene["scalar"] = "float"
    if d.one_in(3):
        scene["batch"] = True
    scene["parallel"] = d.choice(["serial", "tasks", "auto"])
    if d.one_in(3):
        scene["contacts"] = {f"c{i}": {"link": link, "type": d.choice(["weld", "point", "point"]), "at": [0.1 * (i + 1), -0.07, 0.03],
                                       "axes": d.choice(["world", "link"])}
                             for i, link in enumerate(d.sample(links, min(len(links), 1 + d.choice([0, 1, 1, 2, 5]))))}
    if d.one_in(4) and len(links) > 1:
        scene["loops"] = {f"loop{i}": loop_of(d, d.sample(links + ["l0"], 2), d.choice(LOOPS)) for i in range(d.choice([1, 1, 1, 2, 3]))}
    rare = 1 + d.randrange(8)
    constrained = "contacts" in scene or "loops" in scene
    usable = [q for q in quantities if (constrained or not q.startswith(OF_CONSTRAINTS))
              and not (q == "coriolis_matrix" and scene.get("rates_zero"))]
    scene["outputs"] = d.some(usable, rare) or [d.choice(usable)]
    if d.one_in(3):
        scene["functions"] = {"one": d.some(["mass_matrix", "bias", "gravity", "center_of_mass", "momentum_matrix",
                                             d.choice(["inverse_dynamics", "forward_dynamics", "inverse_mass_matrix"])], 2) or ["bias"]}
    if d.one_in(3):
        scene["frames"] = {link: d.some(["pose", "twist", "jacobian", "acceleration_bias", "jacobian_world", "jacobian_mixed",
                                         "acceleration_bias_mixed"], 3) or ["pose"] for link in d.sample(links, min(2, len(links)))}
        if d.one_in(2):
            scene["frames"]["sole"] = {"link": d.choice(links), "at": [0.1, -0.2, 0.3, 0.4, 0, -0.7], "outputs": ["pose", "jacobian_mixed"]}
    if d.one_in(4):
        scene["payloads"] = [d.choice(links)]
    if d.one_in(4):
        scene["wrenches"] = {d.choice(links): d.choice(["link", "world"])}
    driver = d.choice(single)
    for key, value, rare in (("armature", 0.3, 8), ("damping", 0.7, 8), ("friction", 1.1, 8), ("stiffness", {"k": 3, "rest": 0.4}, 8),
                             ("elastic", {"k": 200, "inertia": 0.5, "damping": 0.3}, 16)):
        some = d.some(single, rare)
        if some:
            scene[key] = {joint: value for joint in some}
    drivers = [driver] + (d.sample(single, min(len(single), 2)) if d.one_in(2) else [])
    mimic = [j for j in single if j not in drivers and d.one_in(8) and not any(j in scene.get(k, {}) for k in ("stiffness", "elastic"))]
    if mimic:
        scene["mimic"] = {j: {"of": d.choice(drivers), "multiplier": d.choice([-0.5, 1.5]), "offset": 0.2} for j in mimic}
    if d.one_in(3):
        used = {*drivers, *mimic, *scene.get("stiffness", {}), *scene.get("elastic", {})}
        kinds = {j: (KINDS[0] if j in used else d.choice(KINDS))(d) for j in single if d.one_in(4)}
        if kinds:
            scene["joints"] = kinds
    if d.one_in(6) and len(single) > 2:
        held = [j for j in single if j not in drivers and j not in mimic and d.one_in(5)]
        if held:
            scene["locked"] = {j: 0.3 for j in held}
    if {"constrained_inverse_dynamics", "inverse_constraint_forces"} & {*scene["outputs"]} and d.one_in(2):
        scene["passive"] = [d.choice(single)]
    if scene.get("batch"):
        asked = {*scene["outputs"], *scene.get("functions", {}).get("one", [])}
        if "forward_dynamics" in asked and not constrained and not scene.get("rates_zero"):
            scene["rollouts"] = ["linearly_implicit"]
        elif {"constrained_forward_dynamics", "impact"} <= asked and not scene.get("rates_zero"):
            scene["rollouts"] = ["impacts"]
    embedded = embedded_loop(d, robot) if d.one_in(10) else None
    if embedded:  # which go with fewer keys
        for key in ("contacts", "batch", "rollouts", "mimic", "elastic", "locked", "joints", "forward_dynamics", "functions", "passive"):
            scene.pop(key, None)
        scene.update(parallel="serial", loops={"embedded": embedded},
                     outputs=[q for q in scene["outputs"] if not q.startswith(OF_CONSTRAINTS) and not q.endswith(("_dq", "_dv"))] or ["bias"])
    elif d.one_in(4):
        scene["outputs"] = [{q: part_of(d, single, links, scene["base"])} if q in OF_PARTS and d.one_in(2) else q
                            for q in scene["outputs"]]
    return scene


def toolchain_of(d, native):
    lanes, compiler = d.choice([1, 2, 4, 8]), d.choice(["g++", "g++", "clang++"])
    target = "native" if native else d.choice(["native", "native", "x86-64", "x86-64-v3"])
    # What each output is computed by alone takes most of the time, and scenes of one output are drawn as well.
    return {"compiler": compiler, "form": d.choice(["auto", "auto", "straight", "rolled"]),
            "flags": f"-std={d.choice(['c++17', 'c++20'])} {d.choice(['-O0', '-O1', '-O1', '-O1', '-O2', '-O2', '-O3'])} -march={target} -DDALEMBERT_LANES={lanes}",
            "together": not d.one_in(4)}


def case_of(seed, quantities, native):
    d = Draw(seed)
    robot = robot_of(d)
    return {"robot": robot, "scene": scene_of(d, robot, quantities), "toolchain": toolchain_of(d, native)}


class Cores:
    """Those this process may use, handed out one by one: a check compiles on all that it has."""
    free = queue.SimpleQueue()

    def __init__(self):
        for core in os.sched_getaffinity(0):
            self.free.put(core)

    def run(self, command):
        core = self.free.get()
        try:
            return subprocess.run(["taskset", "--cpu-list", str(core), *command], capture_output=True, text=True, timeout=900)
        finally:
            self.free.put(core)


CORES = Cores()


def command_of(dalembert, verb, folder, case):
    """Of a case whose files are in the folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "robot.urdf").write_text(urdf_of(case["robot"]))
    (folder / "scene.yaml").write_text(json.dumps(case["scene"], indent=1) + "\n")  # JSON is YAML
    return [dalembert, verb, folder / "robot.urdf", "--scene", folder / "scene.yaml", "--form", case["toolchain"]["form"]]


def what_is_compiled(dalembert, folder, case, runtime):
    """A digest of the code of all outputs and, where `check` compiles it, of each by itself, the self-tests that judge them, the
    runtime and the compiler; None where nothing is generated."""
    t, code = case["toolchain"], folder / "code"
    if not toolchain.there(t["compiler"]):
        return None
    text = toolchain.identity(t["compiler"], "native" if "-march=native" in t["flags"] else "any") + t["flags"]
    for output in [None] if t["together"] else [None, *case["scene"]["outputs"]]:
        scene = {**case["scene"], **({"outputs": [output]} if output else {})}
        try:
            done = CORES.run([*command_of(dalembert, "generate", folder, {**case, "scene": scene}), "-o", code])
        except subprocess.TimeoutExpired:
            return None
        if done.returncode == 0:
            text += emitted_code.digest(code.iterdir(), runtime)
            shutil.rmtree(code)
        elif output is None:
            return None
        else:
            text += "refused"
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def run(dalembert, folder, case):
    """'ok', 'refused', or the first line of what is wrong; and all that was said."""
    t = case["toolchain"]
    command = [*command_of(dalembert, "check", folder, case), "--compiler", t["compiler"], "--flags", t["flags"],
               *(["--together"] if t["together"] else [])]
    (folder / "command").write_text(" ".join(f"'{word}'" if " " in str(word) else str(word) for word in command) + "\n")
    try:
        result = CORES.run(command)
    except subprocess.TimeoutExpired:
        return "takes more than a quarter of an hour", ""
    said = result.stderr + result.stdout
    if result.returncode == 0:
        return "ok", said
    if result.returncode == 2 and "error:" in result.stderr and "does not compile" not in said:
        return "refused", said
    wrong = "does not compile" if "does not compile" in said else f"exit status {result.returncode}"
    return wrong, said


def run_unless_known(dalembert, folder, case, runtime, seed, known):
    """As run(), but a case that has passed is not run again: "known"."""
    digest = what_is_compiled(dalembert, folder, case, runtime)
    if digest is not None and known.outcome(seed, digest):
        return "known", ""
    outcome, said = run(dalembert, folder, case)
    if outcome == "ok" and digest is not None:
        known.add(seed, digest, "right")
    return outcome, said


def smaller(dalembert, folder, case, wrong):
    """Entries of the scene left out one after another, and links' inertias and joints made plain, while it fails the same way."""
    def fails(less):
        return run(dalembert, folder, less)[0] == wrong

    changed = True
    while changed:
        changed = False
        for key in list(case["scene"]):
            for part in ([None] + list(case["scene"][key]) if isinstance(case["scene"][key], (dict, list)) else [None]):
                less = json.loads(json.dumps(case))
                if key == "outputs" and part is None:
                    continue
                if part is None:
                    del less["scene"][key]
                elif isinstance(less["scene"].get(key), dict):
                    less["scene"][key].pop(part, None)
                elif isinstance(less["scene"].get(key), list) and part in less["scene"][key]:
                    less["scene"][key].remove(part)
                if less["scene"] != case["scene"] and less["scene"].get(key, True) not in ({}, []) and fails(less):
                    case, changed = less, True
                    if part is None:
                        break
        for i, joint in enumerate(case["robot"]["joints"]):
            if joint["kind"] == "fixed":
                continue
            less = json.loads(json.dumps(case))
            less["robot"]["joints"][i]["kind"] = "fixed"
            if fails(less):
                case, changed = less, True
    run(dalembert, folder, case)  # leaves its files
    return case


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n", 1)[0])
    parser.add_argument("dalembert")
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--first", type=int, default=0, metavar="SEED")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="cases at a time, a core each at most")
    parser.add_argument("--work", type=pathlib.Path, default=pathlib.Path(__file__).resolve().parents[2] / "build" / "random")
    parser.add_argument("--passed", type=pathlib.Path, help="the file that remembers what was right; default: passed.txt in --work")
    parser.add_argument("--native", action="store_true", help="this machine's target alone")
    options = parser.parse_args()
    quantities = words(options.dalembert, "outputs A,B,...")
    options.work.mkdir(parents=True, exist_ok=True)
    given = [pathlib.Path(folder) for folder in os.environ.get("DALEMBERT_INCLUDE", "").split(":") if folder]
    runtime = next((folder for folder in given if (folder / "dalembert/version.hpp").exists()), emitted_code.RUNTIME)
    known = passed.Passed(options.passed or options.work / ("native.txt" if options.native else "passed.txt"))
    outcomes, wrong = [], []
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        futures = {pool.submit(run_unless_known, options.dalembert, options.work / f"{s}", case_of(s, quantities, options.native),
                               runtime, s, known): s for s in range(options.first, options.first + options.cases)}
        for done, future in enumerate(concurrent.futures.as_completed(futures), 1):
            seed, (outcome, said) = futures[future], future.result()
            outcomes.append(outcome)
            known.write()
            if outcome in ("ok", "known", "refused"):
                shutil.rmtree(options.work / f"{seed}")
            else:
                wrong.append((seed, outcome))
                print(f"case {seed}: {outcome}\n{said[-1500:]}", flush=True)
            if done % 25 == 0:
                print(f"{done} of {options.cases}", flush=True)
    remembered, right = outcomes.count("known"), outcomes.count("known") + outcomes.count("ok")
    print(f"{options.cases} cases: {right} right, {outcomes.count('refused')} refused by name, {len(wrong)} wrong"
          + (f"; {remembered} known from runs before" if remembered else ""))
    for seed, outcome in wrong[:5]:
        folder = options.work / f"{seed}"
        least = smaller(options.dalembert, folder, case_of(seed, quantities, options.native), outcome)
        print(f"case {seed}, {outcome}, made smaller: {(folder / 'command').read_text()}{json.dumps(least['scene'])}", flush=True)
    if right < len(outcomes) / 2:
        print("more than half of the cases are refused or wrong: the draw is no test")
        return 1
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
