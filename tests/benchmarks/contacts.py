#!/usr/bin/env python3
"""Times what robots on contacts take against the same without: constrained forward dynamics, impacts, J M⁻¹ Jᵀ and derivatives
beside forward dynamics and theirs, constrained inverse dynamics beside inverse dynamics.

    python3 tests/benchmarks/contacts.py [--robots A,B] [--targets native,avx2,sse2] [--against TREE]

Each quantity is a shared object; all of a robot's run in one process, in turn, from three copies each, as forms.py has it. Prints
medians in ns, and how many times as long as without contacts. Needs the release build.
"""
import argparse
import concurrent.futures
import pathlib
import tempfile

import forms

ROBOTS = {
    "MAHRU": (forms.ROOT / "examples/mahru/mahru.urdf", "{left_foot: weld, right_foot: weld}"),
    "MAHRU_one_foot": (forms.ROOT / "examples/mahru/mahru.urdf", "{left_foot: weld}"),
    "quadruped_12": (forms.ROOT / "tests/robots/quadruped_12.urdf", "{%s}" % ", ".join(
        f"{leg}_3_knee: {{type: point, at: [0, 0, -0.2]}}" for leg in ("front_left", "front_right", "hind_left", "hind_right"))),
}
FREE = {"fd": "forward_dynamics", "id": "inverse_dynamics", "dfd": "forward_dynamics_dq,forward_dynamics_dv"}
CONSTRAINED = {
    "constrained forward dynamics": ("constrained_forward_dynamics", "fd"),
    "impact": ("impact", "fd"),
    "delassus matrix": ("delassus_matrix", "fd"),
    "constrained inverse dynamics": ("constrained_inverse_dynamics", "id"),
    "derivatives": ("constrained_forward_dynamics_dq,constrained_forward_dynamics_dv", "dfd"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robots", default=",".join(ROBOTS), help="of " + ", ".join(ROBOTS))
    parser.add_argument("--targets", default="native", help="of " + ", ".join(forms.TARGETS))
    parser.add_argument("--rounds", type=int, default=101)
    parser.add_argument("--prefix", default="", help="of the command that times: 'taskset -c 1'")
    parser.add_argument("--against", metavar="TREE", help="another checkout, its release build made: its times too")
    options = parser.parse_args()
    if not (forms.BUILD / "bin" / "dalembert").exists():
        parser.error(f"there is no generator in {forms.BUILD}: cmake --preset release && cmake --build --preset release")
    trees = [forms.ROOT] + ([pathlib.Path(options.against).resolve()] if options.against else [])
    pool = concurrent.futures.ThreadPoolExecutor(2)
    with tempfile.TemporaryDirectory(prefix="contacts.", dir=forms.BUILD) as folder:
        forms.FOLDER = pathlib.Path(folder)
        for target in options.targets.split(","):
            for name in options.robots.split(","):
                urdf, contacts = ROBOTS[name]
                quantities = {**{key: (outputs, []) for key, outputs in FREE.items()},
                              **{key: (outputs, ["--contacts", contacts]) for key, (outputs, _) in CONSTRAINED.items()}}
                asked = [(key, tree) for key in quantities for tree in trees]

                def made(case):
                    outputs, more = quantities[case[0]]
                    asks = [urdf, "--base", "floating", "--outputs", "[]", "--functions", "together=" + outputs, "--parallel", "serial"]
                    return forms.compiled(case[0].replace(" ", "_"), target, case[1], asks + more)

                times = dict(zip(asked, forms.timed(list(pool.map(made, asked)), options.rounds, options.prefix.split())))
                print(f"{name}, {target}: " + ", ".join(f"{key} " + " was ".join(f"{times[key, tree]:.0f}" for tree in trees) for key in FREE))
                for key, (_, base) in CONSTRAINED.items():
                    print(f"    {key:30}" + "   was".join(f"{times[key, tree]:8.0f} {times[key, tree] / times[base, tree]:6.2f}" for tree in trees),
                          flush=True)


if __name__ == "__main__":
    main()
