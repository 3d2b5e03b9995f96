"""Two runs of forms.py at once have folders of their own, which they take away.

usage: forms_test.py PROJECT
"""
import pathlib
import subprocess
import sys
import tempfile

benchmarks = pathlib.Path(sys.argv[1]) / "tests/benchmarks"
# In place of what takes minutes: says where it works, leaves a file there, and waits.
RUN = """import pathlib, sys
sys.path.insert(0, sys.argv[1])
import forms
forms.BUILD = pathlib.Path(sys.argv[2])
forms.measure = lambda options: (forms.FOLDER / "driver").touch() or print(forms.FOLDER, flush=True) or input()
del sys.argv[1:]
forms.main()
"""


def demand(good, what):
    if not good:
        sys.exit(f"forms_test: {what}")


with tempfile.TemporaryDirectory() as folder:
    build = pathlib.Path(folder) / "a build"
    (build / "bin").mkdir(parents=True)
    run = [sys.executable, "-c", RUN, benchmarks, build]
    refused = subprocess.run(run, capture_output=True, text=True)
    demand(refused.returncode == 2 and "there is no generator in" in refused.stderr, f"a missing build is not missed: {refused.stderr}")
    (build / "bin/dalembert").touch()
    both = [subprocess.Popen(run, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) for _ in range(2)]
    folders = [pathlib.Path(one.stdout.readline().strip()) for one in both]
    demand(folders[0] != folders[1] and all((f / "driver").exists() for f in folders), f"they work in {folders}")
    for one in both:
        one.communicate("\n")
        demand(one.returncode == 0, "a run fails")
    demand([f.name for f in build.iterdir()] == ["bin"], "something is left behind")
