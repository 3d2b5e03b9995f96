"""The farm: the same file bit for bit whatever the number of ranks, killed ten times or never; errors say what is wrong and leave
nothing. usage: farm_test.py FARM MPIRUN"""

import fcntl
import hashlib
import os
import pathlib
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

try:
    import h5py
    import numpy as np
except ImportError as missing:
    print(f"skipped: {missing} (Debian: python3-h5py)")
    sys.exit(77)

FARM, MPIRUN = sys.argv[1:3]
ENVIRONMENT = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
                   OMPI_MCA_rmaps_base_oversubscribe="1",
                   OMPI_MCA_hwloc_base_binding_policy="none", OMPI_MCA_odls_base_sigkill_timeout="0", OMPI_MCA_pml="ob1", OMPI_MCA_btl="self,vader", ASAN_OPTIONS="detect_leaks=0")
BLOCK = 1024


def words(ranks, *arguments):
    return ([MPIRUN, "-np", str(ranks)] if ranks else []) + [FARM, *map(str, arguments)]


def farm(*arguments, ranks=0, **more):
    """Without ranks no mpirun: a farm of one."""
    alone = {} if ranks else {"OMPI_MCA_ess_singleton_isolated": "1"}
    return subprocess.run(words(ranks, *arguments), env={**ENVIRONMENT, **alone}, capture_output=True, text=True, stdin=subprocess.DEVNULL, **more)


def children(process):
    """The ranks of an mpirun."""
    found = []
    for stat in pathlib.Path("/proc").glob("[0-9]*/stat"):
        try:
            text = stat.read_text()
        except OSError:
            continue
        if int(text.rsplit(")", 1)[1].split()[1]) == process.pid and f"({pathlib.Path(FARM).name[:15]})" in text:
            found.append(int(stat.parent.name))
    return sorted(found)


def journals(out):
    """{(run, rank): [(word, block)]}, of lines that are whole."""
    found = {}
    for file in pathlib.Path(f"{out}.work").glob("journal.*"):
        run, rank = map(int, file.name.split(".")[1:])
        lines = file.read_text().split("\n")[:-1]
        found[run, rank] = [(line.split()[0], int(line.split()[1])) for line in lines]
    return found


class Folder(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="dalembert.farm."))
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.recording = self.folder / "recording.h5"

    def record(self, steps):
        result = farm("record", "--out", self.recording, "--steps", steps)
        self.assertEqual(result.returncode, 0, result.stderr)

    def good(self, result):
        self.assertEqual(result.returncode, 0, result.stderr)
        return result


class Results(Folder):
    def test_one_two_and_four_ranks(self):
        self.record(20)
        for name, arguments in (("sweep", ("sweep", "--states", 9 * BLOCK + 7)),
                                ("short", ("sweep", "--states", 3)),
                                ("identify", ("identify", "--candidates", 9 * BLOCK + 7, "--recording", self.recording))):
            first = None
            for ranks, block in ((0, BLOCK), (2, 2 * BLOCK), (4, BLOCK)):
                if name == "short" and ranks == 4:
                    continue
                out = self.folder / f"{name}{ranks}.h5"
                result = self.good(farm(*arguments, "--out", out, "--block", block, ranks=ranks))
                self.assertIn("a block:", result.stdout)
                self.assertFalse(pathlib.Path(f"{out}.work").exists())
                first = first or out.read_bytes()
                self.assertEqual(out.read_bytes(), first, f"{name}, {ranks} ranks")
        # Once more, and as if killed between its last two steps: all is there, and the folder goes.
        left = pathlib.Path(f"{out}.work")
        left.mkdir()
        for file in ("lock", "settings", "journal.0.0"):
            (left / file).write_text("")
        self.assertIn("complete already", self.good(farm(*arguments, "--out", out)).stdout)
        self.assertFalse(left.exists())
        with h5py.File(self.folder / "sweep2.h5") as file:
            n = 9 * BLOCK + 7
            self.assertEqual({k: v.shape for k, v in file.items()},
                             {"q": (n, 7), "v": (n, 7), "tau": (n, 7), "forward_dynamics": (n, 7), "status": (n,)})
            self.assertTrue((file["status"][:] == -1).all())
            self.assertLess(abs(file["q"][:].mean()), 0.02)
            self.assertTrue((np.abs(file["q"][:]) <= 1.5).all())
            self.assertEqual(len(np.unique(file["q"][:])), 7 * n)
            self.assertGreater(np.abs(file["forward_dynamics"][:]).min(axis=1).max(), 0)
        with h5py.File(self.folder / "identify4.h5") as file:
            cost, payload = file["cost"][:], file["payload"][:]
            self.assertTrue(np.isfinite(cost).all() and (cost > 0).all())
            self.assertTrue(((payload >= [0, -0.15, -0.15, -0.15]) & (payload <= [2.5, 0.15, 0.15, 0.15])).all())
            self.assertLess(cost.min(), np.median(cost) / 100)
        read = subprocess.run([sys.executable, pathlib.Path(__file__).with_name("read.py"), self.folder / "identify4.h5"],
                              capture_output=True, text=True, check=True).stdout
        self.assertRegex(read, r"payload: \(9223, 4\) float64 \[kg, m\].*\n(.*\n)*best: [0-9.]+ kg at")

    def test_results_only_are_the_same(self):
        for more in ((), ("--results-only",)):
            self.good(farm("sweep", "--states", 3000, "--block", BLOCK, "--out", self.folder / f"{len(more)}.h5", *more))
        with h5py.File(self.folder / "0.h5") as whole, h5py.File(self.folder / "1.h5") as part:
            self.assertEqual(list(part), ["forward_dynamics", "status"])
            self.assertTrue((whole["forward_dynamics"][:] == part["forward_dynamics"][:]).all())


class Kills(Folder):
    def test_ten(self):
        self.record(40)
        blocks, ranks, seed = 200, 2, int.from_bytes(os.urandom(4), "little")
        arguments = ("identify", "--candidates", blocks * BLOCK - 5, "--recording", self.recording, "--block", BLOCK, "--out")
        expected = self.folder / "expected.h5"
        self.good(farm(*arguments, expected))
        out, draw = self.folder / "killed.h5", random.Random(seed)
        done, unfinished, log = set(), 0, []
        for kill in range(10):
            before = journals(out)
            there = []
            process = subprocess.Popen(words(ranks if kill % 4 else 4, *arguments, out), env=ENVIRONMENT, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL, start_new_session=True)
            wanted, moment = (draw.randrange(9), draw.uniform(0, 0.01)) if kill % 3 else (0, draw.uniform(0, 0.1))
            patience = time.monotonic() + 60
            while process.poll() is None and time.monotonic() < patience:  # until there are ranks, and that many blocks
                there = there or children(process)
                new = sum(word == "done" for key, lines in journals(out).items() if key not in before for word, _ in lines)
                if there and new >= wanted:
                    break
                time.sleep(0.001)
            time.sleep(moment)
            there = children(process)
            if not there or process.poll() is not None:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
                self.fail(f"kill {kill}, seed {seed}: the run ended by itself: {process.communicate()[1]}")
            os.kill(draw.choice(there), signal.SIGKILL)
            try:
                process.communicate(timeout=20)
            except subprocess.TimeoutExpired:  # mpirun, now and then, waits for ever for a rank that died as it began
                os.killpg(process.pid, signal.SIGKILL)
                process.communicate(timeout=20)
            self.assertNotEqual(process.returncode, 0)
            self.assertFalse(out.exists(), f"kill {kill}, seed {seed}")
            new = {key: lines for key, lines in journals(out).items() if key not in before}
            for key, lines in new.items():
                begun, finished = ([b for word, b in lines if word == w] for w in ("begun", "done"))
                self.assertFalse(done & set(begun), f"kill {kill}, seed {seed}, {key}: what was done is begun again")
                self.assertLessEqual(len(begun) - len(finished), 1, f"kill {kill}, seed {seed}, {key}")
                unfinished += len(begun) - len(finished)
            now = {b for lines in new.values() for word, b in lines if word == "done"}
            self.assertFalse(done & now)
            done |= now
            log.append(len(now))
        self.assertLess(len(done), blocks)
        result = self.good(farm(*arguments, out, ranks=ranks))
        self.assertIn(f"in {blocks} blocks, {blocks - len(done)} of them now", result.stdout)
        self.assertEqual(out.read_bytes(), expected.read_bytes(), f"seed {seed}")
        print(f"ten kills: {log} blocks done before each, {unfinished} of {blocks} begun again")

    def test_one_run_at_a_time_and_the_same_run(self):
        out = self.folder / "out.h5"
        arguments = ("sweep", "--states", 4000 * BLOCK, "--block", BLOCK, "--out", out)
        process = subprocess.Popen(words(0, *arguments), env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        while not journals(out):
            self.assertIsNone(process.poll())
        process.send_signal(signal.SIGSTOP)  # at work, however fast the machine
        result = farm(*arguments)
        self.assertEqual((result.returncode, "another run is at work" in result.stderr), (2, True), result.stderr)
        process.kill()
        process.wait()
        larger = [2 * BLOCK if word == BLOCK else word for word in arguments]
        for other, text in (((*arguments, "--seed", 2), "it says 'seed 1', and this run 'seed 2'"),
                            (larger, "it says 'block 1024', and this run 'block 2048'")):
            result = farm(*other)
            self.assertEqual((result.returncode, text in result.stderr), (2, True), result.stderr)
        # Of a program that computes other bits.
        settings = pathlib.Path(f"{out}.work/settings")
        settings.write_text(settings.read_text().replace("results ", "results 1"))
        result = farm(*arguments)
        self.assertEqual((result.returncode, "it says 'results 1" in result.stderr), (2, True), result.stderr)


    def test_a_run_that_waited_for_another_finds_it_complete(self):
        """While the second waits, the first ends and takes its folder away."""
        out = self.folder / "out.h5"
        work = self.folder / "out.h5.work"
        arguments = ("sweep", "--results-only", "--states", 3000, "--out", out)
        self.good(farm(*arguments))
        first = out.read_bytes()
        out.rename(self.folder / "ready.h5")
        work.mkdir()
        with open(work / "lock", "w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            with subprocess.Popen([FARM, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as second:
                time.sleep(1)
                (self.folder / "ready.h5").rename(out)
                shutil.rmtree(work)
                fcntl.flock(lock, fcntl.LOCK_UN)
                said, wrong = second.communicate(timeout=60)
        self.assertEqual((second.returncode, said), (0, f"{out} is complete already\n"), wrong)
        self.assertEqual(out.read_bytes(), first)
        self.assertFalse(work.exists())


class Errors(Folder):
    def refused(self, text, *arguments, **more):
        there = sorted(self.folder.rglob("*"))
        result = farm(*arguments, **more)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertIn(text, result.stderr)
        self.assertTrue(result.stderr.startswith("farm: "), result.stderr)
        self.assertEqual(sorted(self.folder.rglob("*")), there, "something is left behind")

    def test_arguments(self):
        out = ("--out", self.folder / "out.h5")
        self.refused("no command; 'farm --help'")
        self.refused("'swep': no such command", "swep", *out)
        for n in ("0", "-5", "1e7", "", "99999999999999999999"):
            self.refused(f"--states: '{n}' is no whole number from 1", "sweep", "--states", n, *out)
        self.refused("cannot be reserved", "sweep", "--states", 2**53, *out)
        self.refused("needs --states N", "sweep", *out)
        self.refused("sweep: needs --out", "sweep", "--states", 5)
        self.refused("--out: has no value", "sweep", "--states", 5, "--out")
        self.refused("'--stats': no such option", "sweep", "--stats", 5)
        self.refused("--states: is given twice", "sweep", "--states", 5, "--states", 6, *out)
        self.refused("--candidates: is no option of 'sweep'", "sweep", "--candidates", 5, *out)
        self.refused("--seed: is no option of 'record'", "record", "--seed", 3, *out)
        self.refused("--results-only: is no option of 'identify'", "identify", "--candidates", 5, "--results-only", *out)
        self.refused("1500 is no multiple of 1024", "sweep", "--states", 5, "--block", 1500, *out)
        self.refused("the folder cannot be made: No such file", "sweep", "--states", 5, "--out", self.folder / "not/there.h5")
        (self.folder / "text.h5").write_text("text")
        self.refused("no HDF5 file", "sweep", "--states", 5, "--out", self.folder / "text.h5")
        self.assertEqual((self.folder / "text.h5").read_text(), "text")
        self.refused("'swep': no such command", "swep", *out, ranks=2)

    def test_recordings(self):
        out = ("--candidates", 5, "--out", self.folder / "out.h5")
        self.refused("needs --recording", "identify", *out)
        self.refused("no such HDF5 file", "identify", *out, "--recording", self.folder / "none.h5")
        self.record(10)
        good = {}
        with h5py.File(self.recording) as file:
            good = {name: file[name][:] for name in file}
            step = file.attrs["time_step"]
        self.refused("cannot be made; is there one already", "record", "--out", self.recording)

        def refuse(text, changed, time_step=step):
            bad = self.folder / "bad.h5"
            with h5py.File(bad, "w") as file:
                for name, value in {**good, **changed}.items():
                    if value is not None:
                        file[name] = value
                if time_step is not None:
                    file.attrs["time_step"] = time_step
            self.refused(text, "identify", *out, "--recording", bad)

        refuse("dataset 'q' is missing", {"q": None})
        refuse("dataset 'q' has shape (11, 6), expected (11, 7)", {"q": good["q"][:, :6]})
        refuse("dataset 'v' has shape (10, 7), expected (11, 7)", {"v": good["v"][1:]})
        refuse("dataset 'tau' has shape (10), expected (steps, 7)", {"tau": good["tau"][:, 0]})
        refuse("dataset 'tau' has shape (0, 7)", {"tau": good["tau"][:0]})
        refuse("'v', row 3: a number is not finite", {"v": np.where(np.arange(11)[:, None] == 3, np.nan, good["v"])})
        refuse("attribute 'time_step' is missing", {}, None)
        refuse("no number of seconds larger than zero", {}, -1.0)

    def test_no_room(self):
        def limited():  # MPI needs some
            resource.setrlimit(resource.RLIMIT_FSIZE, (64_000_000, 64_000_000))

        self.refused("are more than a file may have here ('ulimit -f': 64.0 MB)", "sweep", "--states", 300_000, "--out",
                     self.folder / "out.h5", preexec_fn=limited)
        # A disk of little room, which only this process and its children see.
        place, items = self.folder / "disk", 4 * BLOCK
        place.mkdir()
        pages = (items * 60 + 4095) // 4096 + 1  # of the results, and what describes them
        run = f"{FARM} sweep --results-only --states {items} --block {BLOCK} --out {place}/out.h5; echo status $?; ls -A {place}; "
        disk = lambda pages: f"size={4 * pages}k"
        script = (f"mount -t tmpfs -o {disk(pages // 2)} none {place} || exit 77; {run}"
                  f"for more in 1 2 3 4; do mount -o remount,size=$((4 * ({pages} + more)))k {place}; {run} done; "
                  f"mount -o remount,{disk(2 * pages)} {place}; {run} sha256sum < {place}/out.h5")
        result = subprocess.run(["unshare", "--mount", "--map-root-user", "sh", "-c", script], env=ENVIRONMENT, capture_output=True,
                                text=True)
        if result.returncode == 77 or "unshare" in result.stderr:
            self.skipTest("no disk of its own can be had here")
        lines = result.stdout.split("\n")
        self.assertEqual(lines[0], "status 2", result.stderr + result.stdout)  # and nothing there
        self.assertTrue(lines[1].startswith("status"), result.stdout)
        self.assertIn("cannot be reserved: No space left on device; make room there", result.stderr)
        # Then there is room for the results and none for the journal: what is begun is kept.
        self.assertIn("cannot be written: No space left on device", result.stderr)
        self.assertIn("is kept in", result.stderr)
        self.assertIn("status 0", lines, result.stdout)
        whole = self.folder / "whole.h5"
        self.good(farm("sweep", "--results-only", "--states", items, "--out", whole))
        self.assertEqual(lines[-2].split()[0], hashlib.sha256(whole.read_bytes()).hexdigest())


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
