"""Sampling predictive control: an arm of two rods swings up with weak motors. Each tick simulates 10,000 sequences of torques, which
are the last plan with noise, and takes their mean, weighted by how well each does (MPPI: Williams, Aldrich, Theodorou 2017).

The torques may not lift the arm against gravity at once: it has to swing.
"""

import pathlib
import time

import numpy as np

import dalembert
from picture import draw

ROLLOUTS, STEPS, TICKS = 10_000, 25, 100
H = 0.04  # s, a step of the plan and a tick of the controller
LIMIT = np.array([25.0, 12.0])  # N m; the arm hangs down with up to 39 N m on its shoulder when stretched out

urdf = pathlib.Path(__file__).parents[1] / "user_project/arm.urdf"
arm = dalembert.load(urdf, base="fixed", outputs=["forward_dynamics", "potential_energy"], damping={"shoulder": 0.5, "elbow": 0.5})
rng = np.random.default_rng(1)


def step(q, v, tau):
    v = v + H / 2 * arm.forward_dynamics(q, v, tau)
    q = q + H / 2 * v
    v = v + H / 2 * arm.forward_dynamics(q, v, tau)
    return q + H / 2 * v, v


def cost(q, v, tau):
    """Of not standing upright and still: energy below the top, speed there, torque."""
    height = np.cos(q[:, 0]) + np.cos(q[:, 0] + q[:, 1])  # -2 upright, 2 hanging
    return (height + 2) ** 2 + 0.02 * (v**2).sum(axis=1) + 1e-4 * (tau**2).sum(axis=1)


q, v = np.zeros(2), np.zeros(2)
plan = np.zeros((STEPS, 2))
heights, spent = [], []
for tick in range(TICKS):
    start = time.perf_counter()
    tau = np.clip(plan[:, None] + rng.normal(size=(STEPS, ROLLOUTS, 2)) * LIMIT / 2, -LIMIT, LIMIT)
    Q, V, total = np.tile(q, (ROLLOUTS, 1)), np.tile(v, (ROLLOUTS, 1)), np.zeros(ROLLOUTS)
    for t in range(STEPS):
        Q, V = step(Q, V, tau[t])
        total += cost(Q, V, tau[t])
    weights = np.exp((total.min() - total) / (0.05 * (np.median(total) - total.min()) + 1e-9))
    plan = np.einsum("r,tri->ti", weights / weights.sum(), tau)
    spent.append(time.perf_counter() - start)
    q, v = step(q[None], v[None], plan[0][None])
    q, v = q[0], v[0]
    plan = np.vstack([plan[1:], plan[-1:]])
    heights.append(-np.cos(q[0]) - np.cos(q[0] + q[1]))

rate = 1 / np.median(spent)
print(f"{ROLLOUTS} rollouts of {STEPS} steps a tick: {rate:.1f} ticks a second, "
      f"{np.median(spent) / ROLLOUTS / STEPS / 2 * 1e9:.0f} ns a forward dynamics with all of Python around it")
print(f"the hand is {heights[-1]:.2f} m above the shoulder after {TICKS * H:.1f} s, of 2 m")
assert max(heights) > 1.7, "the arm does not swing up"


def plot(pyplot):
    pyplot.plot(H * np.arange(TICKS), heights)
    pyplot.axhline(2, linestyle=":")
    pyplot.xlabel("time, s")
    pyplot.ylabel("the hand above the shoulder, m")
    pyplot.title(f"10,000 rollouts a tick, {rate:.0f} ticks a second")


draw("predictive_control", plot)
