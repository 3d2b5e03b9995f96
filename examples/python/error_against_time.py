"""Error against time of one's own robot: dalembert.report() writes a table of every variant, and this draws one quantity of it.

usage: error_against_time.py FOLDER [ROBOT.urdf]
"""

import csv
import pathlib
import sys
import tempfile

import dalembert
from picture import draw

project = pathlib.Path(__file__).parents[2]
urdf = sys.argv[2] if len(sys.argv) > 2 else project / "examples/user_project/arm.urdf"
with tempfile.TemporaryDirectory() as folder:
    passed, text = dalembert.report(urdf, folder, quick=True, base="fixed", outputs=["mass_matrix"])
    with open(pathlib.Path(folder) / "report.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
print(text)
points = {}
for row in rows:
    if row["section"] == "rounding" and row["quantity"] == "mass_matrix" and row["metric"] in ("time_median", "norm_worst"):
        points.setdefault(row["variant"], {})[row["metric"]] = float(row["value"])
points = {variant: p for variant, p in points.items() if len(p) == 2 and p["norm_worst"] > 0}
for variant, p in sorted(points.items(), key=lambda item: item[1]["time_median"]):
    print(f"{variant:<40}{p['time_median']:>10.0f} ns{p['norm_worst']:>12.1e}")
assert passed and len(points) > 3


def plot(pyplot):
    for variant, p in points.items():
        pyplot.loglog(p["time_median"], p["norm_worst"], "o")
        pyplot.annotate(variant, (p["time_median"], p["norm_worst"]), fontsize=7)
    pyplot.xlabel("mass matrix, ns a call")
    pyplot.ylabel("largest error, of the largest element")


draw("error_against_time", plot)
