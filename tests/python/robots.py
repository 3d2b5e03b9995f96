"""What the tests of the Python package share: robots, a cache of their own, the C functions of generated code."""

import atexit
import ctypes
import faulthandler
import os
import pathlib
import shutil
import subprocess
import tempfile
import threading

project = pathlib.Path(os.environ["DALEMBERT_TEST_PROJECT"])
mahru = project / "examples/mahru/mahru.urdf"



def say_what_is_waited_for():
    """A test that hangs is ended by the suite without a word of where it hung."""
    processes = ["ps", "-ww", "-eLo", "pid,ppid,stat,wchan:24,time,args"]
    timer = threading.Timer(840, lambda: subprocess.run(processes, stdout=2))
    timer.daemon = True
    timer.start()
    faulthandler.dump_traceback_later(850, exit=True)


say_what_is_waited_for()

# The tests' own cache, which they share: what several load is compiled once. The suite begins with an empty one.
cache = os.environ.get("DALEMBERT_TEST_CACHE") or tempfile.mkdtemp(prefix="dalembert.python.")
os.environ["XDG_CACHE_HOME"] = cache
if not os.environ.get("DALEMBERT_TEST_CACHE"):
    atexit.register(shutil.rmtree, cache, True)

# Where speed is not the point: with Eigen precompiled, where the suite says by which flags.
quick = " ".join(["-O0 -std=c++17", os.environ.get("DALEMBERT_TEST_FLAGS", "")]).strip()


def robot(name):
    return project / "tests/robots" / f"{name}.urdf"


def executable():
    return os.environ["DALEMBERT_EXECUTABLE"]


def eval_lines(urdf, output, states, *options):
    """What `dalembert eval` prints of the states, as a list of one list of floats per state."""
    text = "\n".join(" ".join(f"{x:.17g}" for x in state) for state in states) + "\n"
    result = subprocess.run([executable(), "eval", str(urdf), "--state", "-", "--output", output, *options], input=text, text=True,
                            capture_output=True)
    if result.returncode != 0:
        raise RuntimeError(result.stderr)
    return [[float(x) for x in block.split()] for block in result.stdout.split("\n\n")]


def include_folders():
    return [str(project / "runtime/include"), "/usr/include/eigen3"]


class CFunctions:
    """A folder of generated code, compiled (unless told otherwise as docs tell users to) and called through its C interface."""

    def __init__(self, folder, batches=True, flags="-O3 -march=native -std=c++17"):
        self.name = folder.name
        with tempfile.TemporaryDirectory(prefix="dalembert.c.") as temporary:
            library = pathlib.Path(temporary) / "code.so"
            sources = [str(folder / name) for name in ("dynamics.cpp", "c_api.cpp") + (("batch.cpp",) if batches else ())]
            subprocess.run(["c++", *flags.split(), "-shared", "-fPIC",
                            *(word for include in include_folders() for word in ("-isystem", include)), *sources, "-o", str(library)],
                           check=True)
            self.library = ctypes.CDLL(str(library))
        self.workspace = ctypes.c_void_p(self._function("create", ctypes.c_void_p)())

    def _function(self, name, result=None):
        function = getattr(self.library, f"{self.name}_{name}")
        function.restype = result
        return function

    def call(self, function, *vectors):
        self._function(function)(*(ctypes.c_void_p(v.ctypes.data) for v in vectors), self.workspace)

    def call_loops(self, q):
        """Closes embedded loops; the linkage at a toggle point, or -1."""
        return self._function("close_loops", ctypes.c_int)(ctypes.c_void_p(q.ctypes.data), None, None)

    def result(self, name, rows, columns):
        import numpy
        at = self._function(name, ctypes.POINTER(ctypes.c_double))(self.workspace)
        return numpy.ctypeslib.as_array(at, (rows * columns,)).reshape(columns, rows).T.copy()

    def batch(self, function, q, v, more, *results):
        """A call that computes results of as many states as q has rows, in the order of c_api.h."""
        pointer = lambda array: ctypes.c_void_p(None if array is None else array.ctypes.data)
        into = (ctypes.c_void_p * len(results))(*(r.ctypes.data for r in results))
        called, arguments = self._function(f"batch_{function}", ctypes.c_int), (
            pointer(q), pointer(v), pointer(more), ctypes.c_size_t(len(q)), into, None, None)

        def call():
            if called(*arguments) != 0:
                raise RuntimeError(f"{function}: a batch was refused")
        return call
