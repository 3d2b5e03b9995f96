"""Writes the package's type stubs: those of stubs.pyi.in, and of each quantity of the registry a method.

usage: stubs.py registry.json stubs.pyi.in __init__.pyi
"""

import json
import sys

registry_file, template_file, stubs_file = sys.argv[1:]
with open(registry_file, encoding="utf-8") as file:
    registry = json.load(file)
with open(template_file, encoding="utf-8") as file:
    template = file.read()

methods = []
for row in registry["quantities"]:
    arguments = f"v: ArrayLike, {row['takes']}: ArrayLike" if row["takes"] else "v: ArrayLike = ..."
    summary = f"{row['help']} ({row['symbol']}), {row['unit']}"
    methods.append(f"    def {row['name']}(self, q: ArrayLike, {arguments}, *, out: Optional[NDArray[Any]] = ..., "
                   f"return_status: bool = ..., **run_time: ArrayLike) -> Any:\n        \"\"\"{summary}\"\"\"\n")
keys = "".join(f", {key}: Any = ..." for key in registry["scene_keys"])
with open(stubs_file, "w", encoding="utf-8") as file:
    file.write(template.replace("#QUANTITIES#\n", "".join(methods)).replace("#KEYS#", keys))
