"""What a hand holds, found from torques: a plant whose last link carries an unknown load moves along sines, its torques are measured with
noise, and the regressor of the unloaded arm turns them into ten inertial parameters by least squares.
"""

import pathlib

import numpy as np

import dalembert
from picture import draw

project = pathlib.Path(__file__).parents[2]
scene = dict(base="fixed", cut=["left_hip_yaw_link", "right_hip_yaw_link", "left_shoulder_pitch_link"])
mahru = project / "examples/mahru/mahru.urdf"
model = dalembert.load(mahru, outputs=["inverse_dynamics", "regressor"], **scene)
plant = dalembert.load(mahru, outputs=["inverse_dynamics"], payloads=["right_hand"], **scene)
load = dalembert.Payload(mass=1.5, com=(0.02, -0.01, -0.08), inertia=(0.004, 0, 0, 0.005, 0, 0.002))
plant.payload_right_hand = load

rng = np.random.default_rng(4)
n, nv = 4000, model.nv
t = np.linspace(0, 20, n)[:, None]
frequency, phase, amplitude = rng.uniform(2, 6, (3, nv)), rng.uniform(0, 6, (3, nv)), rng.uniform(0.1, 0.3, (3, nv))
Q = (amplitude[:, None] * np.sin(frequency[:, None] * t + phase[:, None])).sum(axis=0)
V = (amplitude[:, None] * frequency[:, None] * np.cos(frequency[:, None] * t + phase[:, None])).sum(axis=0)
A = (-amplitude[:, None] * frequency[:, None] ** 2 * np.sin(frequency[:, None] * t + phase[:, None])).sum(axis=0)
measured = plant.inverse_dynamics(Q, V, A) + rng.normal(0, 0.05, (n, nv))  # N m

# The load rides on the last body: its ten columns of Y are the load's, mass, first moments and inertia about the link's origin.
hand = model.body_names.index("right_hand")
Y = model.regressor(Q, V, A)[:, :, 10 * hand:10 * hand + 10].reshape(-1, 10)
excess = (measured - model.inverse_dynamics(Q, V, A)).reshape(-1)
found, *_ = np.linalg.lstsq(Y, excess, rcond=None)
print(f"mass {found[0]:.4f} kg of {load.mass}, centre of mass {(found[1:4] / found[0]).round(4)} m of {load.com}")
assert abs(found[0] - load.mass) < 0.01 and np.abs(found[1:4] / found[0] - load.com).max() < 0.002

names = ["m", "h_x", "h_y", "h_z"]


def plot(pyplot):
    counts = np.unique(np.geomspace(20, n, 30).astype(int))
    errors = []
    for count in counts:
        some, *_ = np.linalg.lstsq(Y[:count * nv], excess[:count * nv], rcond=None)
        errors.append([abs(some[0] - load.mass), *np.abs(some[1:4] - load.mass * np.array(load.com))])
    pyplot.loglog(counts, errors)
    pyplot.legend(["mass, kg", "first moments, kg m, x", "y", "z"])
    pyplot.xlabel("samples")
    pyplot.ylabel("error")


draw("identify_payload", plot)
