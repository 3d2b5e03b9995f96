"""Numbers from Python: the same bits as from C++, every quantity of the registry, batches as single states, threads, speed."""

import os
import pickle
import threading
import time
import unittest
import warnings

import numpy as np

import robots
import dalembert

warnings.simplefilter("ignore", dalembert.InputWarning)


def best_time(call, rounds=30, calls=300):
    """The least time of a call, over rounds."""
    best = float("inf")
    for _ in range(rounds):
        start = time.perf_counter()
        for _ in range(calls):
            call()
        best = min(best, (time.perf_counter() - start) / calls)
    return best


class Mahru(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.keywords = dict(base="floating", outputs=["mass_matrix", "bias", "forward_dynamics"])
        start = time.perf_counter()
        cls.robot = dalembert.load(robots.mahru, **cls.keywords)
        cls.first_load = time.perf_counter() - start
        rng = np.random.default_rng(33)
        cls.Q = cls.robot.random(rng, 64)
        cls.V = rng.uniform(-2, 2, (64, cls.robot.nv))
        cls.TAU = rng.uniform(-20, 20, (64, cls.robot.nv))

    def test_the_same_bits_as_the_generated_folder(self):
        """robot.source is what ran: compiled and called as C, it gives these bits; so does each output's own folder."""
        whole = robots.CFunctions(self.robot.source)
        alone = robots.CFunctions(self.robot.source.parent / f"mass_matrix_of_{self.robot.source.name}")
        nv = self.robot.nv
        for q, v, tau in zip(self.Q[:8], self.V, self.TAU):
            whole.call("evaluate", q, v)
            together = self.robot.evaluate(q, v)
            for name, columns in (("mass_matrix", nv), ("bias", 1)):
                self.assertEqual(getattr(together, name).tobytes(), np.ascontiguousarray(whole.result(name, nv, columns)).tobytes())
            whole.call("forward_dynamics", q, v, tau)
            self.assertEqual(self.robot.forward_dynamics(q, v, tau).tobytes(),
                             np.ascontiguousarray(whole.result("forward_dynamics_result", nv, 1)).tobytes())
            alone.call("evaluate", q, v)
            self.assertEqual(self.robot.mass_matrix(q).tobytes(), np.ascontiguousarray(alone.result("mass_matrix", nv, nv)).tobytes())

    def test_batches_are_single_states(self):
        r = self.robot
        Q, V, TAU = (np.tile(x, (65, 1)) for x in (self.Q, self.V, self.TAU))  # enough for threads
        for function, arguments in ((r.mass_matrix, (Q,)), (r.bias, (Q, V)), (r.forward_dynamics, (Q, V, TAU))):
            many = function(*arguments)
            for s in (0, 1, 63, 64, 2000, len(Q) - 1):
                self.assertEqual(many[s].tobytes(), function(*(x[s] for x in arguments)).tobytes())
            self.assertEqual(many[:64].tobytes(), many[-64:].tobytes())
        one_v = r.bias(Q[:64], V[0])
        self.assertEqual(one_v.tobytes(), r.bias(Q[:64], np.tile(V[0], (64, 1))).tobytes())
        M, h = r.evaluate(Q[:64], V[:64])
        self.assertEqual(M[5].tobytes(), r.evaluate(Q[5], V[5]).mass_matrix.tobytes())
        self.assertEqual(h.shape, (64, r.nv))

    def test_ten_threads_call_one_robot(self):
        r, expected = self.robot, [self.robot.bias(q, v) for q, v in zip(self.Q, self.V)]
        batch = self.robot.bias(self.Q, self.V)
        wrong = []

        def work(seed):
            rng = np.random.default_rng(seed)
            for _ in range(200):
                s = rng.integers(64)
                if not np.array_equal(r.bias(self.Q[s], self.V[s]), expected[s]):
                    wrong.append(s)
                if not np.array_equal(r.bias(self.Q, self.V), batch):
                    wrong.append("batch")

        threads = [threading.Thread(target=work, args=(i,)) for i in range(10)]
        for t in threads:
            t.start()
        for t in threads:
            t.join()
        self.assertEqual(wrong, [])

    def test_a_child_of_fork_computes_too(self):
        r = self.robot
        Q, V = np.tile(self.Q, (64, 1)), np.tile(self.V, (64, 1))
        expected = r.bias(Q, V)  # the threads are there
        child = os.fork()
        if child == 0:
            os._exit(0 if np.array_equal(r.bias(Q, V), expected) and np.array_equal(r.bias(Q[0], V[0]), expected[0]) else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_pickled_it_is_loaded_again(self):
        start = time.perf_counter()
        again = pickle.loads(pickle.dumps(self.robot))
        self.assertLess(time.perf_counter() - start, self.first_load / 3)
        self.assertEqual(again.bias(self.Q, self.V).tobytes(), self.robot.bias(self.Q, self.V).tobytes())

    def test_the_second_load_is_quick(self):
        # Under 50 ms on a core of one's own; here the least of several, with room for whoever else is computing.
        times = []
        for _ in range(10):
            start = time.perf_counter()
            dalembert.load(robots.mahru, **self.keywords)
            times.append(time.perf_counter() - start)
        print(f"MAHRU: first load {self.first_load:.1f} s, second {min(times) * 1e3:.1f} ms")
        self.assertLess(min(times), 0.2)

    def test_what_a_call_costs(self):
        r, q, v = self.robot, self.Q[0], self.V[0]
        out = np.empty((r.nv, r.nv))
        mass_matrix = r.mass_matrix
        call = best_time(lambda: mass_matrix(q, out=out)) - best_time(lambda: None)
        small = best_time(lambda: r.bias(q, v)) - best_time(lambda: None)
        n = 4096
        Q = np.tile(self.Q, (64, 1))
        OUT = np.empty((n, r.nv, r.nv))
        before = dalembert.threads()
        dalembert.threads(1)
        batch = best_time(lambda: r.mass_matrix(Q, out=OUT), 10, 1) / n
        dalembert.threads(before)
        print(f"MAHRU: M with out= {call * 1e9:.0f} ns, bias {small * 1e9:.0f} ns, M in a batch of {n} on one thread {batch * 1e9:.0f} ns "
              f"a state")
        self.assertLess(call - batch, 5e-6)  # 1 µs on a core of one's own


class Eval(unittest.TestCase):
    # What is solved for may be found in another way there, and is the same to rounding.
    def test_the_same_numbers_as_eval(self):
        urdf = robots.robot("skew_axes")
        robot = dalembert.load(urdf, base="fixed", outputs=["mass_matrix", "bias", "forward_dynamics"])
        rng = np.random.default_rng(8)
        n = 5
        q, v, tau = robot.random(rng, n), rng.normal(size=(n, robot.nv)), rng.normal(size=(n, robot.nv))
        for name, arguments in (("mass_matrix", (q, v)), ("bias", (q, v)), ("forward_dynamics", (q, v, tau))):
            expected = robots.eval_lines(urdf, name, np.hstack(arguments), "--base", "fixed", "--engine", "generated")
            result = robot[name](*arguments).reshape(n, -1)
            if name == "forward_dynamics":
                np.testing.assert_allclose(result, expected, rtol=0, atol=1e-12 * np.abs(expected).max())
            else:
                self.assertEqual(result.tolist(), expected, name)


class Registry(unittest.TestCase):
    """Whatever stands in the registry is a function of a robot, with the generic engine's numbers."""

    def test_every_quantity(self):
        urdf, link = robots.robot("double_pendulum"), "link_02"
        robot = dalembert.load(urdf, base="floating", outputs=list(dalembert.quantities()),
                               frames={link: list(dalembert.link_quantities())}, contacts={link: "weld"}, flags=robots.quick)
        names = [*dalembert.quantities(), *(f"{q}_{link}" for q in dalembert.link_quantities())]
        self.assertGreater(len(names), 25)
        rng = np.random.default_rng(1)
        n = 3
        q, v, more = robot.random(rng, n), rng.uniform(-1, 1, (n, robot.nv)), rng.uniform(-1, 1, (n, robot.nv))
        for name in names:
            with self.subTest(name):
                takes = dalembert.quantities().get(name, {"takes": ""})["takes"]
                states = np.hstack([q, v, more]) if takes else np.hstack([q, v])
                function = robot[name]
                values = function(q, v, more) if takes else function(q, v)
                expected = np.array(robots.eval_lines(urdf, name, states, "--base", "floating", "--contacts",
                                                          f"{link}=weld", "--engine", "generic"))
                self.assertEqual(values.shape[0], n)
                self.assertEqual(values.size, expected.size)
                scale = np.abs(expected).max()
                self.assertLess(np.abs(values.reshape(expected.shape) - expected).max(), 1e-9 * max(scale, 1e-3))
                one = function(q[0], v[0], more[0]) if takes else function(q[0], v[0])
                self.assertEqual(np.asarray(one).tobytes(), np.ascontiguousarray(values[0]).tobytes())
                self.assertIn(name if name in robot.outputs else "", function.__doc__)
        self.assertEqual(set(names), set(robot.outputs))
        with self.subTest("a contact that is let go"):
            held = robot.constrained_forward_dynamics(q, v, more)
            robot.contact_link_02 = dalembert.Contact(active=False)
            free = robot.constrained_forward_dynamics(q, v, more)
            self.assertLess(np.abs(free - robot.forward_dynamics(q, v, more)).max(), 1e-9 * np.abs(free).max())
            self.assertFalse(np.allclose(held, free))
            robot.contact_link_02 = dalembert.Contact()
            self.assertTrue(np.array_equal(robot.constrained_forward_dynamics(q, v, more), held))
        with self.subTest("weights of forces"):
            borne = robot.inverse_constraint_forces(q, v, more)
            robot.contact_link_02 = dalembert.Contact(weight=(1, 1, 1, 0.1, 0.1, 0.1))
            self.assertTrue(np.allclose(robot.inverse_constraint_forces(q, v, more), borne))  # one weld alone has no choice
            robot.contact_link_02 = dalembert.Contact()
        together = robot.evaluate(q, v, a=more, tau=more, outputs=names)
        for name, values in zip(names, together):
            self.assertEqual(np.shape(values)[0], n, name)
            takes = dalembert.quantities().get(name, {"takes": ""})["takes"]
            alone = robot[name](q, v, more) if takes else robot[name](q, v)
            self.assertLess(np.abs(values - alone).max(), 1e-9 * max(1, np.abs(alone).max()), name)


if __name__ == "__main__":
    unittest.main()
