"""Sampling predictive control: an arm of two rods swings up with weak motors. Each tick simulates 10,000 sequences of torques, which
are the last plan with noise, in one call, and takes their mean, weighted by how well each does (MPPI: Williams, Aldrich, Theodorou
2017).

The torques may not lift the arm against gravity at once: it has to swing.
"""

import pathlib
import time

import numpy as np

import dalembert
from picture import draw

ROLLOUTS, STEPS, TICKS = 10_000, 25, 100
H = 0.04  # s, a step of the plan and a tick of the controller
LIMIT = np.float32([25.0, 12.0])  # N m; the arm hangs down with up to 39 N m on its shoulder when stretched out

urdf = pathlib.Path(__file__).parents[1] / "user_project/arm.urdf"
arm = dalembert.load(urdf, base="fixed", scalar=np.float32, outputs=["forward_dynamics"], damping={"shoulder": 0.5, "elbow": 0.5})
rng = np.random.default_rng(1)


def cost(q, v, tau):
    """Of not standing upright and still: energy below the top, speed there, torque."""
    height = np.cos(q[..., 0]) + np.cos(q[..., 0] + q[..., 1])  # -2 upright, 2 hanging
    return (height + 2) ** 2 + np.float32(0.02) * np.einsum("...i,...i", v, v) + np.float32(1e-4) * np.einsum("...i,...i", tau, tau)


q, v, plan = np.zeros(2, arm.dtype), np.zeros(2, arm.dtype), np.zeros((STEPS, 2), arm.dtype)
Q, V = np.empty((2, ROLLOUTS, STEPS, 2), arm.dtype)
heights, spent, simulating = [], [], []
for tick in range(TICKS):
    start = time.perf_counter()
    tau = np.clip(plan + rng.standard_normal((ROLLOUTS, STEPS, 2), arm.dtype) * (LIMIT / 2), -LIMIT, LIMIT)
    begun = time.perf_counter()
    arm.forward_dynamics_rollout(q, v, tau, time_step=H, method="rk4", path=True, out=(Q, V))
    simulating.append(time.perf_counter() - begun)
    total = cost(Q, V, tau).sum(axis=1)
    weights = np.exp((total.min() - total) / (0.05 * (np.median(total) - total.min()) + 1e-9))
    plan = np.tensordot(weights / weights.sum(), tau, 1)
    spent.append(time.perf_counter() - start)
    q, v = arm.forward_dynamics_rollout(q, v, plan[:1], time_step=H, method="rk4")
    plan = np.vstack([plan[1:], plan[-1:]])
    heights.append(-np.cos(q[0]) - np.cos(q[0] + q[1]))

rate, rollouts = 1 / np.median(spent), np.median(simulating)
print(f"{ROLLOUTS} rollouts of {STEPS} steps a tick: {rate:.1f} ticks a second; the rollouts alone {rollouts * 1e3:.1f} ms, "
      f"{rollouts / ROLLOUTS / STEPS / 4 * 1e9:.1f} ns an evaluation on {dalembert.threads()} threads")
print(f"the hand is {heights[-1]:.2f} m above the shoulder after {TICKS * H:.1f} s, of 2 m")
assert max(heights) > 1.7, "the arm does not swing up"


def plot(pyplot):
    pyplot.plot(H * np.arange(TICKS), heights)
    pyplot.axhline(2, linestyle=":")
    pyplot.xlabel("time, s")
    pyplot.ylabel("the hand above the shoulder, m")
    pyplot.title(f"10,000 rollouts a tick, {rate:.0f} ticks a second")


draw("predictive_control", plot)
