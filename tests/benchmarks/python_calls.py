"""What Python adds: the first load of a robot, the second, a call with and without out=, a batch beside the C++ batch.

PYTHONPATH=build/release/python python3 tests/benchmarks/python_calls.py [URDF]
"""

import os
import pathlib
import resource
import sys
import tempfile
import time

with tempfile.TemporaryDirectory() as cache:
    os.environ["XDG_CACHE_HOME"] = cache  # the first load is one
    import numpy as np

    import dalembert

    urdf = sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parents[2] / "examples/mahru/mahru.urdf"
    n = 4096

    def cores():
        """Seconds of any core so far, the children's among them."""
        return sum(resource.getrusage(who).ru_utime + resource.getrusage(who).ru_stime
                   for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))

    def least(calls, rounds=30):
        """The least time of each call, over rounds in which they take turns: whoever else computes slows all of them."""
        best = [float("inf")] * len(calls)
        for _ in range(rounds):
            for i, (call, count) in enumerate(calls):
                start = time.perf_counter()
                for _ in range(count):
                    call()
                best[i] = min(best[i], (time.perf_counter() - start) / count)
        return best

    def load():
        start, before = time.perf_counter(), cores()
        robot = dalembert.load(urdf, base="floating", outputs=["mass_matrix", "bias"])
        return robot, time.perf_counter() - start, cores() - before

    robot, first, of_cores = load()
    second = min(load()[1] for _ in range(10))
    print(f"{robot.name}: first load {first:.1f} s, {of_cores:.1f} s of a core; second {second * 1e3:.1f} ms")

    rng = np.random.default_rng(33)
    Q, V = robot.random(rng, n), rng.uniform(-2, 2, (n, robot.nv))
    q, v, out = Q[0], V[0], np.empty((robot.nv, robot.nv))
    OUT = np.empty((n, robot.nv, robot.nv))
    mass_matrix = robot.mass_matrix
    dalembert.threads(1)
    one_by_one = dalembert.load(urdf, base="floating", outputs=["mass_matrix", "bias"], batch=False)
    nothing, call, returned, bias, inside, batch = least([
        (lambda: None, 300), (lambda: mass_matrix(q, out=out), 300), (lambda: mass_matrix(q), 300),
        (lambda: robot.bias(q, v), 300), (lambda: one_by_one.mass_matrix(Q[:32], out=OUT[:32]), 10), (lambda: mass_matrix(Q, out=OUT), 1)])
    print(f"M with out= {(call - nothing) * 1e9:.0f} ns, {inside / 32 * 1e9:.0f} of them the function's own; M returned "
          f"{(returned - nothing) * 1e9:.0f} ns; bias {(bias - nothing) * 1e9:.0f} ns")
    print(f"M of {n} states as a batch, one thread: {batch / n * 1e9:.0f} ns a state")
