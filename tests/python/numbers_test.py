"""Numbers from Python: the same bits as from C++, every quantity of the registry, batches as single states, threads."""

import json
import os
import pathlib
import pickle
import threading
import unittest
import warnings

import numpy as np

import robots
import dalembert

warnings.simplefilter("ignore", dalembert.InputWarning)


class Mahru(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.keywords = dict(base="floating", outputs=["mass_matrix", "bias"], flags=robots.quick)
        cls.robot = dalembert.load(robots.mahru, **cls.keywords)
        rng = np.random.default_rng(33)
        cls.Q = cls.robot.random(rng, 64)
        cls.V = rng.uniform(-2, 2, (64, cls.robot.nv))

    def test_the_same_bits_as_the_generated_folder(self):
        """robot.source is what several quantities in one call are: compiled and called as C, it gives these bits. A quantity alone is
        the folder that source_of() names. Of batches, too: the C++ batch's bits."""
        r = self.robot
        self.assertEqual(r.source_of("mass_matrix").name, f"mass_matrix_of_{r.source.name}")
        whole = robots.CFunctions(r.source, batches=False, flags=robots.quick)
        alone = robots.CFunctions(r.source_of("mass_matrix"), flags=robots.quick)
        nv = r.nv
        for q, v in zip(self.Q[:8], self.V):
            whole.call("evaluate", q, v)
            together = r.evaluate(q, v)
            for name, columns in (("mass_matrix", nv), ("bias", 1)):
                self.assertEqual(getattr(together, name).tobytes(), np.ascontiguousarray(whole.result(name, nv, columns)).tobytes())
            alone.call("evaluate", q, v)
            self.assertEqual(r.mass_matrix(q).tobytes(), np.ascontiguousarray(alone.result("mass_matrix", nv, nv)).tobytes())
        n = 4096
        Q = np.tile(self.Q, (n // 64, 1))
        expected, result = np.empty((n, nv, nv)), np.empty((n, nv, nv))
        in_c = alone.batch("evaluate", Q, None, None, expected)
        in_c()
        r.mass_matrix(Q, out=result)
        self.assertEqual(result.tobytes(), expected.tobytes())

    def test_a_part_is_rows_and_columns_of_the_whole(self):
        part = dalembert.load(robots.mahru, base="floating", outputs=[{"mass_matrix": {"subtree": "left_shoulder_pitch_link"}}],
                              flags=robots.quick, batch=False)
        first = 6 + part.joint_names.index("left_shoulder_pitch")
        whole, M = self.robot.mass_matrix(self.Q[0])[first:first + 6, first:first + 6], part.mass_matrix(self.Q[0])
        self.assertEqual(M.shape, (6, 6))
        self.assertLess(np.abs(M - whole).max(), 1e-13 * np.abs(whole).max())
        self.assertIn("rows and columns: left_shoulder_pitch to left_wrist_pitch", part.mass_matrix.__doc__)
        with self.assertRaisesRegex(dalembert.InputError, "did you mean 'left_elbow'"):
            dalembert.load(robots.mahru, outputs=[{"mass_matrix": {"joints": ["left_elbo"]}}])

    def test_a_state_has_the_same_bits_wherever_it_stands(self):
        r = self.robot
        Q, V = (np.tile(x, (65, 1)) for x in (self.Q, self.V))  # enough for threads
        for function, arguments in ((r.mass_matrix, (Q,)), (r.bias, (Q, V))):
            many = function(*arguments)
            for s in (0, 1, 63, 64, 2000, len(Q) - 1):
                one = function(*(x[s] for x in arguments))
                self.assertEqual(many[s].tobytes(), function(*(x[s:s + 1] for x in arguments))[0].tobytes())
                self.assertLess(np.abs(many[s] - one).max(), 1e-11 * np.abs(one).max())  # a call's, to rounding
            self.assertEqual(many[:64].tobytes(), many[-64:].tobytes())
            self.assertEqual(many[::-3].tobytes(), function(*(x[::-3] for x in arguments)).tobytes())
            wide = [np.hstack([x, x])[:, :x.shape[1]] for x in arguments]  # rows apart
            self.assertEqual(many.tobytes(), function(*wide).tobytes())
        self.assertEqual(r.bias(Q[:130], V[0]).tobytes(), r.bias(Q[:130], np.tile(V[0], (130, 1))).tobytes())

    def test_state_by_state_where_batches_are_not_wanted(self):
        r = dalembert.load(robots.robot("double_pendulum"), base="fixed", outputs=["mass_matrix", "bias"], batch=False, flags=robots.quick)
        rng = np.random.default_rng(4)
        Q, V = r.random(rng, 300), rng.normal(size=(300, r.nv))
        M, h = r.evaluate(Q, V)
        self.assertEqual(M[5].tobytes(), r.evaluate(Q[5], V[5]).mass_matrix.tobytes())
        self.assertEqual(h.shape, (300, r.nv))
        self.assertEqual(r.bias(Q, V)[299].tobytes(), r.bias(Q[299], V[299]).tobytes())
        self.assertEqual(list(r.source.parent.parent.glob("batches_*.so")), [])

    def test_ten_threads_call_one_robot(self):
        r = self.robot
        expected, batch = [r.bias(*x) for x in zip(self.Q, self.V)], r.bias(self.Q, self.V)
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
        Q = np.tile(self.Q, (64, 1))
        expected, one = r.mass_matrix(Q), r.mass_matrix(Q[0])  # the threads are there
        child = os.fork()
        if child == 0:
            os._exit(0 if np.array_equal(r.mass_matrix(Q), expected) and np.array_equal(r.mass_matrix(Q[0]), one) else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)

    def test_a_second_load_compiles_nothing(self):
        """Nor does unpickling. Other tests fill the same cache at the same time: what was there stays as it was, and is what is loaded."""
        libraries = lambda: sorted((f, f.stat().st_mtime_ns) for f in pathlib.Path(os.environ["XDG_CACHE_HOME"]).rglob("*.so"))
        files = libraries()
        again = pickle.loads(pickle.dumps(self.robot)), dalembert.load(robots.mahru, **self.keywords)
        self.assertLessEqual(set(files), set(libraries()))
        self.assertTrue(files)
        for robot in again:
            self.assertEqual(robot.source, self.robot.source)
            self.assertEqual(robot.mass_matrix(self.Q).tobytes(), self.robot.mass_matrix(self.Q).tobytes())


class Eval(unittest.TestCase):
    def test_the_same_bits_as_eval(self):
        """Of one state, and of a batch those of eval's engine `batch`."""
        urdf, flags = robots.robot("skew_axes"), robots.quick
        robot = dalembert.load(urdf, base="fixed", outputs=["mass_matrix", "bias", "forward_dynamics"], flags=flags)
        rng = np.random.default_rng(8)
        n = 5
        q, v, tau = robot.random(rng, n), rng.normal(size=(n, robot.nv)), rng.normal(size=(n, robot.nv))
        states, options = np.hstack((q, v, tau)), ("--base", "fixed", "--flags", flags, "--engine")
        expected = robots.eval_lines(urdf, "forward_dynamics", states, *options, "generated")
        self.assertEqual([robot.forward_dynamics(*state).tolist() for state in zip(q, v, tau)], expected)
        expected = robots.eval_lines(urdf, "forward_dynamics", states, *options, "batch")
        self.assertEqual(robot.forward_dynamics(q, v, tau).tolist(), expected)


class Registry(unittest.TestCase):
    """Whatever stands in the registry is a function of a robot, with the generic engine's numbers."""

    def test_every_quantity(self):
        urdf, link = robots.robot("double_pendulum"), "link_02"
        frames = {link: list(dalembert.link_quantities()),
                  "sole": {"link": link, "at": [0.1, -0.2, 0.3, 0.4, 0, -0.5], "outputs": ["pose", "jacobian_mixed"]}}
        ours = [{"mass_matrix": "crba", "bias": "nle"}.get(name, name) for name in dalembert.quantities()]  # the field's names
        robot = dalembert.load(urdf, base="floating", outputs=ours, frames=frames,
                               contacts={link: "weld"}, flags=robots.quick, batch=False)
        names = [*dalembert.quantities(), *(f"{q}_{link}" for q in dalembert.link_quantities()), "pose_sole",
                 "jacobian_mixed_sole"]
        self.assertIn("sole", robot.frame_names)
        self.assertGreater(len(names), 25)
        rng = np.random.default_rng(1)
        n = 3
        q, v, more = robot.random(rng, n), rng.uniform(-1, 1, (n, robot.nv)), rng.uniform(-1, 1, (n, robot.nv))
        for name in names if "DALEMBERT_LONG_TESTS" in os.environ else names[::2]:  # each alone is compiled
            with self.subTest(name):
                takes = dalembert.quantities().get(name, {"takes": ""})["takes"]
                states = np.hstack([q, v, more]) if takes else np.hstack([q, v])
                function = robot[name]
                values = function(q, v, more) if takes else function(q, v)
                expected = np.array(robots.eval_lines(urdf, name, states, "--base", "floating", "--contacts",
                                                          f"{link}=weld", "--frames", json.dumps(frames), "--engine",
                                                          "generic"))
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
        for name in ("forward_dynamics", "constrained_forward_dynamics"):
            with self.subTest(f"rollouts of {name}"):  # without a batch: integrators of C++
                h, acting = 0.01, np.stack([more, -more, 0 * more], 1)
                at, speed = q, v
                for step in range(3):
                    speed = speed + h * robot[name](at, speed, acting[:, step])
                    at = robot.integrate(at, h * speed)
                roll_out = getattr(robot, f"{name}_rollout")
                for one in (roll_out(q, v, acting, time_step=h), roll_out(q, v, acting, time_step=h, path=True)):
                    last = [x[:, -1] if x.ndim == 3 else x for x in one]
                    np.testing.assert_allclose(last[0], at, rtol=0, atol=1e-12)
                    np.testing.assert_allclose(last[1], speed, rtol=0, atol=1e-11 * np.abs(speed).max())
                fine = [roll_out(q, v, np.repeat(acting, k, 1), time_step=h / k, method="rk4").q for k in (1, 2, 16)]
                errors = [np.abs(robot.difference(x, fine[2])).max() for x in fine[:2]]
                self.assertLess(errors[1], errors[0] / 8)
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
