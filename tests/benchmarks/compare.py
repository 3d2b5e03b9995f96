#!/usr/bin/env python3
"""Compares the speed of two commits' generated code, interleaved on this machine.

    python3 tests/benchmarks/compare.py OLD [NEW] [--filter MAHRU/] [--rounds 15]       NEW: HEAD if not given

Builds benchmark_peers of both commits in worktrees below build/compare (kept, so that a second comparison is quick; remove
them with `git worktree remove`), runs them in turn, and prints new / old per benchmark: the median of the rounds' ratios and
its spread. Below 1 the new commit is faster. MuJoCo's rows tell how far the machine can be trusted: they should read 1.
"""
import argparse
import pathlib
import subprocess

import measure

ROOT = pathlib.Path(__file__).resolve().parents[2]


def git(*arguments):
    return subprocess.run(["git", "-C", str(ROOT), *arguments], check=True, stdout=subprocess.PIPE, text=True).stdout.strip()


def built(commit):
    """The path of the commit's benchmark_peers."""
    tree = ROOT / "build" / "compare" / git("rev-parse", "--short=12", f"{commit}^{{commit}}")
    if not tree.exists():
        git("worktree", "add", "--detach", str(tree), commit)
    print(f"== Building {commit} in {tree}", flush=True)
    quiet = {"check": True, "cwd": tree, "stdout": subprocess.DEVNULL}
    subprocess.run(["cmake", "--preset", "release"], **quiet)
    subprocess.run(["cmake", "--build", "--preset", "release", "--target", "benchmark_peers"], **quiet)
    return tree / "build" / "release" / "bin" / "benchmark_peers"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old")
    parser.add_argument("new", nargs="?", default="HEAD")
    parser.add_argument("--filter", default="(MAHRU|DRC-Hubo|Atlas|WAM|KR5)/", help="of benchmarks, a regular expression")
    parser.add_argument("--rounds", type=int, default=15)
    options = parser.parse_args()
    programs = [built(options.old), built(options.new)]
    pattern = f"^{options.filter}.*/(dalembert|mujoco)$"

    times = {}  # name → ([old], [new])
    for turn in range(options.rounds):
        order = (0, 1) if turn % 2 == 0 else (1, 0)
        for which in order:
            for name, row in measure.run(programs[which], pattern, 1, 0.02).items():
                times.setdefault(name, ([], []))[which].append(row["times"][0])
    print(f"{'benchmark':32} {'old':>10} {'new':>10} {'new/old':>8} {'spread':>7}")
    for name, (old, new) in times.items():
        if not old or not new:
            print(f"{name:32} only in {'new' if new else 'old'}")
            continue
        ratios = [b / a for a, b in zip(old, new)]
        print(f"{name:32} {measure.duration(measure.median(old)):>10} {measure.duration(measure.median(new)):>10} "
              f"{measure.median(ratios):8.3f} {measure.spread(ratios):7.1%}")


if __name__ == "__main__":
    main()
