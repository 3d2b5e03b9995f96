"""The cache: many processes at once, killed compilers, a full disk, changed inputs, and the command that lists and clears it."""

import os
import pathlib
import signal
import stat
import subprocess
import sys
import tempfile
import time
import unittest

import robots

URDF = robots.robot("pendulum")
LOAD = """
import sys, dalembert, numpy
robot = dalembert.load(sys.argv[1], base="fixed", outputs=["mass_matrix"], compiler=sys.argv[2] or None, flags="-O0 -std=c++17")
print(robot.mass_matrix(numpy.zeros(robot.nq))[0, 0])
"""
BATCH = LOAD + "print(*robot.mass_matrix(numpy.zeros((3, robot.nq)))[:, 0, 0])\n"
# The cache is cleared, and the robot perhaps another, before batches are asked for first.
LATER = LOAD + """
import os, pathlib, subprocess
subprocess.run([os.environ["DALEMBERT_EXECUTABLE"], "cache", "--clear"], check=True, stdout=subprocess.DEVNULL)
if len(sys.argv) > 3:
    pathlib.Path(sys.argv[1]).write_text(sys.argv[3])
print(*robot.mass_matrix(numpy.zeros((3, robot.nq)))[:, 0, 0])
"""


class Cache(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="dalembert.cache.")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.environment = dict(os.environ, XDG_CACHE_HOME=str(self.folder / "cache"))
        self.entries = self.folder / "cache/dalembert"

    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory(prefix="dalembert.objects.")
        cls.addClassCleanup(folder.cleanup)
        cls.objects = folder.name

    def compiler(self, before=""):
        """A compiler that writes down each time it is called, and has the objects of all tests at hand: what it is given again, it
        does not compile again."""
        path = self.folder / "compiler"
        text = f"""#!/bin/sh
echo x >> {self.folder}/calls
{before}
for word; do
  case $before in -c) from=$word ;; -o) to=$word ;; esac
  before=$word
done
[ -z "$from" ] && exec c++ "$@"
kept={self.objects}/$({{ basename "$from"; cat "$from" "${{from%/objects/*}}"/source/*/*.?pp; }} | md5sum | cut -c1-32)
[ -e "$kept" ] || {{ c++ "$@" && cp "$to" "$kept.$$" && mv "$kept.$$" "$kept"; }} || exit 1
exec cp "$kept" "$to"
"""
        if not path.exists() or path.read_text() != text:  # its date is part of what an entry is known by
            path.write_text(text)
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def calls(self):
        log = self.folder / "calls"
        return len(log.read_text().split()) if log.exists() else 0

    def start(self, compiler="", urdf=URDF, program=LOAD, arguments=(), **more):
        return subprocess.Popen([sys.executable, "-W", "ignore", "-c", program, str(urdf), str(compiler), *arguments],
                                env=self.environment, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **more)

    def load(self, compiler="", *arguments, **more):
        process = self.start(compiler or self.compiler(), *arguments, **more)
        out, err = process.communicate()
        self.assertEqual(process.returncode, 0, err)
        return out

    def left(self):
        return sorted(p.name for p in self.entries.iterdir()) if self.entries.exists() else []

    def test_twenty_processes_compile_once(self):
        compiler = self.compiler()
        processes = [self.start(compiler, program=BATCH) for _ in range(20)]
        results = {p.communicate() for p in processes}
        self.assertEqual(len(results), 1, results)
        self.assertTrue(all(p.returncode == 0 for p in processes), results)
        self.assertEqual(self.calls(), 5)  # the code, its self-test, the linker; the batch, the linker
        self.assertEqual(len(self.left()), 1)
        self.load(compiler, program=BATCH)
        self.assertEqual(self.calls(), 5)

    def test_killed_while_compiling(self):
        compiler = self.compiler(f"[ -e {self.folder}/go ] || sleep 600")
        for whole_group in (True, False):
            process = self.start(compiler, start_new_session=True)
            for _ in range(600):
                if self.calls() > 0:
                    break
                time.sleep(0.1)
            (self.folder / "calls").unlink()
            if whole_group:
                os.killpg(process.pid, signal.SIGKILL)
            else:  # the generator alone: its compilers live on
                child = int(pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children").read_text().split()[0])
                os.kill(child, signal.SIGKILL)
            process.communicate()
            self.assertNotEqual(process.returncode, 0)
            self.assertTrue(any(".making." in name for name in self.left()))
            if not whole_group:
                (self.folder / "go").touch()
        expected = self.load("c++")  # by another compiler: another entry
        start = time.perf_counter()
        self.assertEqual(self.load(compiler), expected)
        self.assertLess(time.perf_counter() - start, 300)  # it does not wait for those who sleep
        self.assertFalse([name for name in self.left() if ".making." in name or ".lock" in name], self.left())
        try:
            os.killpg(process.pid, signal.SIGKILL)  # the sleeping compilers of ours
        except ProcessLookupError:
            pass

    def test_a_full_disk(self):
        """Files that may not grow are what a full disk looks like."""
        limited = "import resource, runpy, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (8000, 8000)); sys.argv = sys.argv[1:]\n"
        for_python = LOAD.replace("\nimport sys, dalembert, numpy", "\n" + limited + "import dalembert, numpy\nsys.argv.insert(0, '')")
        result = subprocess.run([sys.executable, "-W", "ignore", "-c", for_python, str(URDF), ""], env=self.environment,
                                capture_output=True, text=True)
        self.assertNotEqual(result.returncode, 0)
        self.assertRegex(result.stderr, "InputError: .*(cannot be written|does not compile)")
        self.assertEqual(self.left(), [])
        self.load()

    def test_what_changes_makes_another_entry(self):
        urdf = self.folder / "robot.urdf"
        urdf.write_text(URDF.read_text())
        first = self.load("", urdf)
        self.assertEqual(len(self.left()), 1)
        urdf.write_text(URDF.read_text().replace("<mass value=\"", "<mass value=\"1"))
        self.assertNotEqual(self.load("", urdf), first)
        self.assertEqual(len(self.left()), 2)
        urdf.write_text(URDF.read_text())
        self.assertEqual(self.load("", urdf), first)
        self.assertEqual(len(self.left()), 2)
        listed = subprocess.run([robots.executable(), "cache"], env=self.environment, capture_output=True, text=True, check=True).stdout
        self.assertEqual(listed.count("robot.urdf --base fixed --outputs"), 2, listed)
        self.assertNotIn("\\", listed)  # as a shell takes it
        # A damaged entry is made again.
        for code in self.entries.glob("*/code.so"):
            code.write_bytes(code.read_bytes()[:100])
        self.assertEqual(self.load("", urdf), first)
        cleared = subprocess.run([robots.executable(), "cache", "--clear"], env=self.environment, capture_output=True, text=True, check=True)
        self.assertIn("2 removed", cleared.stdout)
        self.assertEqual(self.left(), [])
        self.assertEqual(self.load("", urdf), first)

    def test_batches_after_the_cache_was_cleared(self):
        urdf = self.folder / "robot.urdf"
        urdf.write_text(URDF.read_text())
        one, many = self.load("", urdf, program=LATER).split("\n", 1)
        self.assertEqual(many.split(), [one] * 3)
        process = self.start(self.compiler(), urdf, LATER, [URDF.read_text().replace("<mass value=\"", "<mass value=\"1")])
        out, err = process.communicate()
        self.assertIn("InputError: " + str(urdf) + " is not what it was when it was loaded", err)
        # Half a batch, a disk's doing, is compiled again.
        urdf.write_text(URDF.read_text())
        self.load("", urdf, program=BATCH)
        for code in self.entries.glob("*/batches_*.so"):
            code.write_bytes(code.read_bytes()[:100])
        self.assertEqual(self.load("", urdf, program=BATCH).split()[0], one)

    def test_a_folder_that_is_none(self):
        (self.folder / "cache").write_text("")
        process = self.start()
        self.assertIn("InputError", process.communicate()[1])


if __name__ == "__main__":
    unittest.main()
