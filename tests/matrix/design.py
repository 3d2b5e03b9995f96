"""Which cells of the matrix are visited: programs (robot, form, outputs) against toolchains (compiler, level, target, lanes)."""
import collections
import itertools
import pathlib

# All that evaluate() computes, and all that the functions beside it do.
ALL = ("mass_matrix,coriolis_matrix,gravity,bias,wrench_influence,kinetic_energy,potential_energy,center_of_mass,"
       "center_of_mass_jacobian,center_of_mass_bias,momentum_matrix,momentum_bias,inverse_mass_matrix")
FUNCTIONS = ("inverse_dynamics,inverse_dynamics_dq,inverse_dynamics_dv,regressor,forward_dynamics,forward_dynamics_dq,"
             "forward_dynamics_dv")
SINGLE = ["gravity", "mass_matrix", "bias", "mass_matrix,coriolis_matrix"]

# One robot of each topology, fixed and floating, revolute and prismatic, and two whole humanoids, the second from Debian's
# dart-doc if it is installed.
ROBOTS = {
    "mahru": "examples/mahru/mahru.urdf", "drchubo": "/usr/share/doc/dart/data/urdf/drchubo/drchubo.urdf",
    "pendulum": "tests/robots/pendulum.urdf", "chain_7": "tests/robots/chain_7.urdf",
    "skew_axes": "tests/robots/skew_axes.urdf", "unequal_limbs": "tests/robots/unequal_limbs.urdf",
    "two_levels_of_branching": "tests/robots/two_levels_of_branching.urdf",
    "prismatic_mix": "tests/robots/prismatic_mix.urdf", "gantry_arms": "tests/robots/gantry_arms.urdf",
    "quadruped": "tests/robots/quadruped.urdf", "hexapod": "tests/robots/hexapod.urdf", "hand": "tests/robots/hand.urdf",
    "tree_5x20": "tests/robots/tree_5x20.urdf",
}
URDFS = ROBOTS | {"humanoid": "tests/robots/humanoid.urdf", "grippers": "tests/robots/grippers.urdf",
                  "ankle": "tests/numeric/generated/mechanisms/ankle.urdf"}
# Robots with a scene: links that are pushed along their own axes or the world's, joints that drive others, functions of the
# scene's own, joints with a motor behind a spring.
PUSHED, DRIVEN, ELASTIC = "pushed", "driven", "elastic"
# And: links that are held, by M's factors and by articulated bodies, rows and columns of some joints, a parallel ankle whose rods'
# loops are embedded; many states at once, on contacts too.
HELD, STANDING, PARTS, EMBEDDED, BATCHED = "held", "standing", "parts", "embedded", "batched"
LINKS = {"mahru": ("left_hand", "right_foot"), "unequal_limbs": ("b_3", "d_5"), "gantry_arms": ("a_tool", "b_carriage"),
         "hexapod": ("leg_2_3_tibia", "leg_6_2_femur"), "hand": ("f1_index_4_distal", "f4_small_2_proximal")}
JOINTS = {"mahru": ("left_elbow", "right_elbow"), "unequal_limbs": ("b_2_joint", "d_4_joint"),
          "gantry_arms": ("a_lift_joint", "b_lift_joint"), "hexapod": ("leg_2_3_tibia_joint", "leg_6_2_femur_joint"),
          "hand": ("f1_index_3_middle_joint", "f4_small_3_middle_joint")}
FORMS = ["rolled", "straight"]
COMPILERS = ["g++-11", "g++-12", "clang++-14", "clang++-16", "clang++-19"]
LEVELS = ["-O0", "-O1", "-O2", "-O3"]
TARGETS = ["x86-64", "x86-64-v2", "x86-64-v3", "x86-64-v4", "skylake-avx512", "icelake-server", "rocketlake", "sapphirerapids",
           "znver2", "znver3", "native"]
LANES = [1, 2, 4, 8]
AARCH64 = "aarch64-linux-gnu-g++"
# Where g++ 12.2 copies constants wrongly.
WITH_DEFECT = ["x86-64-v4", "skylake-avx512", "icelake-server", "rocketlake", "sapphirerapids", "native"]


def options(robot, outputs):
    """Of `dalembert generate`: outputs, and the scene that stands for some."""
    if outputs == PUSHED:
        own, world = LINKS[robot]
        return ["--outputs", "inverse_dynamics,inverse_dynamics_dq,forward_dynamics", "--wrenches", f"{own}=link,{world}=world",
                "--functions", "{balance: [mass_matrix, momentum_matrix], plan: [inverse_mass_matrix, forward_dynamics_dq]}"]
    if outputs == DRIVEN:
        driver, driven = JOINTS[robot]
        functions = "{step: [inverse_mass_matrix, forward_dynamics], plan: [forward_dynamics_dq, forward_dynamics_dv]}"
        return ["--outputs", "mass_matrix,mass_matrix_factor,bias,forward_dynamics", "--functions", functions,
                "--mimic", f"{{{driven}: {{of: {driver}, multiplier: -0.7}}}}", "--friction", f"{driver}=0.3,{driven}=0.2"]
    if outputs == ELASTIC:
        springs = ", ".join(f"{joint}: {{k: 700, inertia: 0.1, damping: 3}}" for joint in JOINTS[robot])
        return ["--outputs", "mass_matrix,coriolis_matrix,bias,potential_energy,inverse_dynamics_dq,forward_dynamics",
                "--elastic", f"{{{springs}}}"]
    if outputs == HELD:
        weld, point = LINKS[robot]
        return ["--outputs", "constrained_forward_dynamics,constraint_forces,impact,delassus_matrix,constrained_forward_dynamics_dq,"
                "constraint_forces_dv", "--contacts", f"{{{weld}: weld, {point}: point}}"]
    if outputs == STANDING:
        weld, point = LINKS[robot]
        return ["--base", "floating", "--outputs", "constrained_forward_dynamics,constraint_forces,impact,constrained_inverse_dynamics",
                "--contacts", f"{{{weld}: weld, {point}: point}}"]
    if outputs == BATCHED:
        return [*options(robot, STANDING), "--batch", "true", "--rollouts", "impacts", "--functions", "{free: [bias, forward_dynamics]}"]
    if outputs == PARTS:
        link, _ = LINKS[robot]
        rows = f"{{subtree: {link}}}"
        return ["--outputs", f"[{{mass_matrix: {rows}}}, {{coriolis_matrix: {{joints: {list(JOINTS[robot])}}}}}, {{bias: {rows}}}, "
                f"{{momentum_matrix: {rows}}}, {{regressor: {{links: [{link}]}}}}]", "--frames", f"{{{link}: [{{jacobian_mixed: {rows}}}]}}"]
    if outputs == EMBEDDED:
        return ["--scene", pathlib.Path(__file__).parents[2] / URDFS[robot].replace(".urdf", ".yaml")]
    return ["--outputs", outputs]


def name(outputs):
    """Of folders and in messages."""
    return {ALL: "all", FUNCTIONS: "functions"}.get(outputs, outputs.replace(",", "+"))


def programs(robots):
    """Every robot in both forms, with all outputs of evaluate() together, those of the functions beside it, and some alone.
    Straight lines of a hundred joints: what is short."""
    return [program for program in itertools.product(robots, FORMS, [*SINGLE, ALL, FUNCTIONS])
            if not (program[1] == "straight" and program[0] in ("tree_5x20", "drchubo") and program[2] not in SINGLE[:3])]


def parts(program):
    """What is to meet every compiler, level, target and lane width: a robot in one form, and outputs in one form."""
    return [program[:2], program[1:]]


def constraints(_):
    """Contacts, parts of results and embedded loops: each with every compiler; levels, targets and widths take turns."""
    return taking_turns([*itertools.product(LINKS, FORMS, [HELD, STANDING, PARTS]), *itertools.product(["ankle"], FORMS, [EMBEDDED])])


def batches(_):
    """Batches and rollouts, likewise: of functions with contacts and without."""
    return taking_turns(itertools.product(LINKS, ["rolled"], [BATCHED]))


def taking_turns(scenes):
    """Each scene with every compiler; levels, targets and widths take turns."""
    cells = []
    for i, (scene, compiler) in enumerate(itertools.product(scenes, [*COMPILERS, AARCH64])):
        target = "aarch64" if compiler == AARCH64 else TARGETS[i * 7 % len(TARGETS)]
        cells.append((scene, (compiler, LEVELS[1 + (i + i // 6) % 3], target, LANES[(i // 3 + i // 4) % len(LANES)])))
    return cells


def whole(robots):
    """Six parts, see tests/README.md: the defect's neighbourhood in full, aarch64, scenes, and every toolchain on programs that
    take turns."""
    cells = [(program, tools)
             for program in itertools.product(["mahru", "gantry_arms", "hand"], ["rolled"], ["gravity"])
             for tools in itertools.product(["g++-12"], ["-O2", "-O3"], WITH_DEFECT, LANES)]
    every = programs(robots)
    for i, (level, lanes) in enumerate(itertools.product(LEVELS, LANES)):
        cells += [(every[(7 * i + step) % len(every)], (AARCH64, level, "aarch64", lanes)) for step in (0, 37)]
    met, uses = set(), collections.Counter()
    toolchains = list(itertools.product(COMPILERS, LEVELS, TARGETS, LANES))
    scenes = list(itertools.product(LINKS, FORMS, [PUSHED, DRIVEN]))
    for i, (level, lanes, compiler) in enumerate(itertools.product(LEVELS, LANES, [*COMPILERS, AARCH64])):
        target = "aarch64" if compiler == AARCH64 else TARGETS[i * 7 % len(TARGETS)]
        cells.append((scenes[(i * 7 + i // len(scenes)) % len(scenes)], (compiler, level, target, lanes)))
    scenes = list(itertools.product(LINKS, FORMS, [ELASTIC]))
    for i, (lanes, compiler) in enumerate(itertools.product(LANES, [*COMPILERS, AARCH64])):
        target = "aarch64" if compiler == AARCH64 else TARGETS[i * 7 % len(TARGETS)]
        cells.append((scenes[(i * 3 + i // len(scenes)) % len(scenes)], (compiler, LEVELS[(i + i // 6) % len(LEVELS)], target, lanes)))
    cells += constraints(robots)
    # In an order that has met a bit of everything at any time, in case the run is cut short.
    for i in range(len(toolchains)):
        tools = toolchains[i * 367 % len(toolchains)]
        best = min(every, key=lambda p: (sum((part, value) in met for part in parts(p) for value in tools), uses[p]))
        met.update((part, value) for part in parts(best) for value in tools)
        uses[best] += 1
        cells.append((best, tools))
    cells += batches(robots)
    return list(dict.fromkeys(cells))


def ci(_):
    """What fits into less than a minute with the compilers that cmake/setup.sh's group `test` installs: the defect of g++ 12.2, both
    forms, other lanes, a debug build; clang, which compiles the rest of `sh tests/run.sh`, for other targets."""
    return [
        (("mahru", "rolled", "gravity"), ("g++", "-O2", "native", 4)),
        (("quadruped", "rolled", ALL), ("g++", "-O0", "x86-64", 1)),
        (("gantry_arms", "straight", ALL), ("g++", "-O3", "skylake-avx512", 4)),
        (("unequal_limbs", "rolled", STANDING), ("g++", "-O1", "native", 4)),
        (("ankle", "rolled", EMBEDDED), ("clang++", "-O2", "skylake-avx512", 8)),
    ]
