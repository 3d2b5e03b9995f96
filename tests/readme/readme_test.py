"""Runs the commands of README.md, in order, from the top of the project.

usage: readme_test.py PROJECT BUILD    BUILD takes the place of build/release

Commands that would build everything again are run by whoever started this test; they are listed here with who that is.
"""

import pathlib
import re
import shutil
import subprocess
import sys

RUN_ELSEWHERE = {
    "sh examples/mahru/run.sh": "same steps, other build folder: tests mahru_controller_fixed and mahru_controller_floating",
    "sh tests/run.sh": "runs this test; called by .ci/run",
    "cmake --preset release": "tests/run.sh",
    "cmake --build --preset release": "tests/run.sh",
}

project, build = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
text = (project / "README.md").read_text(encoding="utf-8")
work = project / "build" / "try"
shutil.rmtree(work, ignore_errors=True)

commands = 0
for block in re.findall(r"^```sh\n(.*?)^```$", text, re.MULTILINE | re.DOTALL):
    lines = [line for line in block.splitlines() if line not in RUN_ELSEWHERE]
    if not lines:
        continue
    script = "\n".join(lines).replace("build/release", f"'{build}'")
    print(script, flush=True)
    result = subprocess.run(["sh", "-e", "-c", script], cwd=project, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    print(result.stdout[-2000:], flush=True)
    if result.returncode != 0:
        sys.exit(f"README.md: exit status {result.returncode}")
    commands += len(lines)
if commands == 0:
    sys.exit("README.md: no commands found")

for link in re.findall(r"\]\((?!https?:)([^)#]+)\)", text):
    if not (project / link).exists():
        sys.exit(f"README.md: {link} does not exist")
