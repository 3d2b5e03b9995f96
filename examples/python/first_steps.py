"""docs/python.md in one piece: an arm loaded, its dynamics at one state and at thousands, what is wrong refused by name."""

import pathlib

import numpy as np

import dalembert

urdf = pathlib.Path(__file__).parents[1] / "user_project/arm.urdf"
robot = dalembert.load(urdf, base="fixed", outputs=["mass_matrix", "bias", "forward_dynamics"], frames=["forearm"])
print(robot)
print("joints:", *robot.joint_names)

q, v = robot.neutral(), np.zeros(robot.nv)
M = robot.mass_matrix(q)
h = robot.bias(q, v)
print("M =", M, "h =", h, sep="\n")
print("held by h it stays:", robot.forward_dynamics(q, v, h).round(12) + 0.0)
print("the forearm's frame is at", robot.pose_forearm(q)[:, 3])

rng = np.random.default_rng(0)
Q, V, TAU = robot.random(rng, 4096), rng.normal(size=(4096, robot.nv)), rng.normal(size=(4096, robot.nv))
A = robot.forward_dynamics(Q, V, TAU)
worst = np.abs(np.einsum("nij,nj->ni", robot.mass_matrix(Q), A) + robot.bias(Q, V) - TAU).max()
print(f"of {len(A)} states, M dv + h - tau is at most {worst:.0e}")
assert worst < 1e-9

try:
    robot.bias(q, v[:-1])
except ValueError as error:
    print("refused:", error)
print("the C++ for the controller is in", robot.source)
