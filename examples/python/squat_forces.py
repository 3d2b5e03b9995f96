"""MAHRU squats on both feet: the forces under them. Inverse dynamics of the motion says what the floating base misses, and the feet's
Jacobians distribute it, the smallest pair of wrenches that holds the robot; the joints' torques follow.
"""

import pathlib

import numpy as np

import dalembert
from picture import draw

project = pathlib.Path(__file__).parents[2]
robot = dalembert.load(project / "examples/mahru/mahru.urdf", base="floating",
                       outputs=["inverse_dynamics", "potential_energy", "center_of_mass"],
                       frames={foot: ["jacobian_mixed", "pose"] for foot in ("left_foot", "right_foot")})

# A squat: hips, knees and ankles bend so that the feet stay flat, and the base goes down so that they stay where they are.
n, h = 801, 0.0025
bend = 0.45 * (1 - np.cos(2 * np.pi * np.arange(n) * h / 2.0)) / 2  # rad, once in two seconds
Q = np.tile(robot.neutral(), (n, 1))
joint = {name: 7 + i for i, name in enumerate(robot.joint_names)}
for side in ("left", "right"):
    Q[:, joint[f"{side}_hip_pitch"]] = -bend
    Q[:, joint[f"{side}_knee"]] = 2 * bend
    Q[:, joint[f"{side}_ankle_pitch"]] = -bend
feet = robot.pose_left_foot(Q)[:, :, 3]
Q[:, :3] -= feet - feet[0]
worst = np.abs(robot.pose_right_foot(Q) - robot.pose_right_foot(Q[0])).max()
print(f"the feet move by {worst:.1e}")
assert worst < 1e-12

# Velocities and accelerations by differences on the states' group.
V = (robot.difference(Q[:-2], Q[2:])) / (2 * h)
A = (V[2:] - V[:-2]) / (2 * h)
Q, V = Q[2:-2], V[1:-1]

tau = robot.inverse_dynamics(Q, V, A)
J = np.concatenate([robot.jacobian_mixed_left_foot(Q), robot.jacobian_mixed_right_foot(Q)], axis=1)  # (n, 12, nv)
# Six equations of the base, twelve numbers: J_base' F = tau_base, the least F.
F = np.einsum("nij,nj->ni", np.linalg.pinv(np.swapaxes(J[:, :, :6], 1, 2)), tau[:, :6])
joints = tau - np.einsum("nij,ni->nj", J, F)
vertical = F[:, 2] + F[:, 8]

# Newton: what the feet push is the weight and what moves the centre of mass.
center = robot.center_of_mass(Q)[:, 2]
rise = np.gradient(np.gradient(center, h), h)
mass = (robot.potential_energy(Q)[0] / (9.81 * center[0]))
error = np.abs(vertical - mass * (9.81 + rise))[10:-10].max()
print(f"{mass:.1f} kg: feet push {vertical.min():.0f} to {vertical.max():.0f} N, within {error:.2f} N of weight and motion; "
      f"knees hold up to {np.abs(joints[:, joint['left_knee'] - 1]).max():.0f} N m")
assert np.abs(joints[:, :6]).max() < 1e-8 and error < 0.02 * mass * 9.81
t = h * np.arange(len(Q))


def plot(pyplot):
    pyplot.plot(t, F[:, 2], label="left foot, vertical")
    pyplot.plot(t, F[:, 8], "--", label="right foot, vertical")
    pyplot.plot(t, joints[:, joint["left_knee"] - 1], label="left knee, N m")
    pyplot.xlabel("time, s")
    pyplot.ylabel("N, N m")
    pyplot.legend()


draw("squat_forces", plot)
