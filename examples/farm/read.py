"""Reads what a farm has computed: python3 read.py FILE.h5

Of an identification the candidates that move most like the recording, of a sweep where its extremes are. It is what any HDF5 file is.
"""

import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1], "r") as file:
    print(file.attrs["settings"].decode(), end="")
    for name, dataset in file.items():
        unit = dataset.attrs["unit"].decode().strip("\0")
        print(f"{name}: {dataset.shape} {dataset.dtype} {unit and '[' + unit + '] '}{dataset.attrs['meaning'].decode()}")
    if "cost" in file:
        best = np.argsort(file["cost"][:])[:20]
        loads, cost = file["payload"][:][best], file["cost"][:][best]
        print(f"best: {loads[0, 0]:.3f} kg at {loads[0, 1:].round(3)} m, {cost[0]:.2e} rad^2 from the recording")
        print(f"of the best 20: {loads[:, 0].mean():.3f} ± {loads[:, 0].std():.3f} kg")
    else:
        sizes = np.abs(file["forward_dynamics"]).max(axis=0)
        print(f"largest accelerations: {sizes.round(1)} rad/s^2")
