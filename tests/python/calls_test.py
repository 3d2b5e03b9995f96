"""What functions take and refuse: shapes, dtypes, strides, keywords, run-time inputs, states on their group; made-up arguments."""

import copy
import ctypes
import inspect
import os
import pathlib
import pickle
import re
import tempfile
import unittest
import warnings

import numpy as np

import made_up
import robots
import dalembert

warnings.simplefilter("ignore", dalembert.InputWarning)

CASES = int(os.environ.get("DALEMBERT_TEST_CASES", "200"))


STIFF = dict(damping={"link_01_joint": 1e3, "link_02_joint": 2}, stiffness={"link_02_joint": 1e6})


def setUpModule():
    global double, single, arm, stiff
    urdf = robots.robot("double_pendulum")
    scene = dict(base="floating", outputs=["mass_matrix", "kinetic_energy", "forward_dynamics", "inverse_dynamics"],
                 gravity="run_time", payloads=["link_02"], wrenches={"link_02": "world"},
                 functions={"both": ["bias", "center_of_mass", "pose_link_02"], "info": ["bias"]}, flags=robots.quick, batch=True)
    double = dalembert.load(urdf, **scene)
    single = dalembert.load(urdf, scalar=np.float32, base="fixed", outputs=["mass_matrix", "bias", "forward_dynamics"], flags=robots.quick, batch=False)
    arm = dalembert.load(urdf, base="fixed", outputs="forward_dynamics", flags=robots.quick.split(), payloads=["link_02"])
    stiff = dalembert.load(urdf, base="fixed", outputs=["mass_matrix", "bias", "forward_dynamics"], flags=robots.quick, batch=True,
                           rollouts=["linearly_implicit"], **STIFF)


class Rollouts(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(32)
        self.n, self.steps, self.h = 21, 7, 0.01
        self.Q, self.V = double.random(rng, self.n), rng.uniform(-1, 1, (self.n, double.nv))
        self.TAU = rng.uniform(-1, 1, (self.n, self.steps, double.nv))
        self.q, self.v = arm.random(rng, self.n), rng.uniform(-1, 1, (self.n, arm.nv))
        self.tau = rng.uniform(-1, 1, (self.n, self.steps, arm.nv))

    def test_single_steps_give_the_same_bits(self):
        q, v = self.q, self.v
        end = arm.forward_dynamics_rollout(q, v, self.tau, time_step=self.h)
        path = arm.forward_dynamics_rollout(q, v, self.tau, time_step=self.h, path=True)
        self.assertEqual((end.q.shape, path.v.shape), ((self.n, arm.nq), (self.n, self.steps, arm.nv)))
        for step in range(self.steps):
            one = arm.forward_dynamics_rollout(q, v, self.tau[:, step:step + 1], time_step=self.h)
            # The code is compiled without fused operations, so that numpy rounds as it does.
            v = v + self.h * arm.forward_dynamics(q, v, self.tau[:, step])
            q = q + self.h * v
            for result in (one, (path.q[:, step], path.v[:, step])):
                self.assertEqual((result[0].tobytes(), result[1].tobytes()), (q.tobytes(), v.tobytes()))
        self.assertEqual((end.q.tobytes(), end.v.tobytes()), (q.tobytes(), v.tobytes()))

    def test_the_same_bits_as_from_c(self):
        """The C function of the folder's batch, in the library that the robot has loaded; of every method."""
        arguments = [np.ascontiguousarray(x) for x in (self.q, self.v, self.tau)]
        arm.forward_dynamics_rollout(*arguments, time_step=self.h)  # compiles it
        folder = arm.source_of("forward_dynamics")
        for library in folder.parent.parent.glob("batches_*.so"):
            function = getattr(ctypes.CDLL(str(library)), f"{folder.name}_rollout_forward_dynamics", None)
        pointer = lambda x: ctypes.c_void_p(x.ctypes.data)
        size = ctypes.c_size_t
        for number, method in enumerate(("semi_implicit_euler", "rk4")):
            last = [np.empty((self.n, k)) for k in (arm.nq, arm.nv)]
            path = [np.empty((self.n, self.steps, k)) for k in (arm.nq, arm.nv)]
            stopped = np.empty(self.n, np.int32)
            self.assertEqual(function(*map(pointer, arguments), size(self.n), size(self.steps), ctypes.c_double(self.h), number,
                                      *map(pointer, (*last, *path, stopped)), None), 0)
            for expected, whole in ((last, False), (path, True)):
                result, status = arm.forward_dynamics_rollout(*arguments, time_step=self.h, method=method, path=whole,
                                                              return_status=True)
                self.assertEqual([x.tobytes() for x in result], [x.tobytes() for x in expected])
                self.assertEqual(status.tolist(), stopped.tolist())

    def test_linearly_implicit_steps(self):
        """(M + h D + h² K) v' = tau - C v - g - D v - K q - h K v, by numpy; and explicit steps of the same size blow up."""
        h, steps, roll_out = 0.01, 50, stiff.forward_dynamics_rollout
        joints = list(stiff.joint_names)
        D, K = (np.diag([STIFF[key].get(joint, 0.0) for joint in joints]) for key in ("damping", "stiffness"))
        self.assertEqual((np.trace(D), np.trace(K)), (1002, 1e6))
        q, v, tau = self.q, self.v, np.random.default_rng(4).uniform(-1, 1, (self.n, steps, 2))
        path, status = roll_out(q, v, tau, time_step=h, method="linearly_implicit", path=True, return_status=True)
        self.assertEqual(status.tolist(), [-1] * self.n)
        for step in range(steps):
            system = stiff.mass_matrix(q) + h * D + h * h * K
            right = tau[:, step] - stiff.bias(q, v) - h * v @ K
            expected = v + h * np.linalg.solve(system, right[..., None])[..., 0]
            scale = 1e-12 * max(1, np.abs(expected).max(), np.abs(v).max())
            np.testing.assert_allclose(path.v[:, step], expected, rtol=0, atol=scale)
            np.testing.assert_allclose(path.q[:, step], q + h * path.v[:, step], rtol=0, atol=scale)
            q, v = path.q[:, step], path.v[:, step]
        self.assertLess(np.abs(v).max(), 10)
        _, status = roll_out(self.q, self.v, steps=1000, time_step=h, return_status=True)
        self.assertGreaterEqual(status.min(), 0)
        for robot in (double, arm, single):
            with self.assertRaisesRegex(ValueError, r"load the robot with batch=True and rollouts=\['linearly_implicit'\]"):
                robot.forward_dynamics_rollout(robot.neutral(), np.zeros(robot.nv), steps=1, time_step=h, method="linearly_implicit")
        with self.assertRaisesRegex(dalembert.InputError, "write batch: true"):
            dalembert.load(robots.robot("double_pendulum"), outputs="forward_dynamics", rollouts=["linearly_implicit"])

    def test_a_floating_base_as_integrate_has_it(self):
        q, v = self.Q, self.V
        result = double.forward_dynamics_rollout(q, v, self.TAU, time_step=self.h)
        for step in range(self.steps):
            v = v + self.h * double.forward_dynamics(q, v, self.TAU[:, step])
            q = double.integrate(q, self.h * v)
        np.testing.assert_allclose(result.q, q, rtol=0, atol=1e-12)
        np.testing.assert_allclose(result.v, v, rtol=0, atol=1e-11)
        exact = [double.forward_dynamics_rollout(self.Q, self.V, np.repeat(self.TAU, k, axis=1), time_step=self.h / k, method="rk4")
                 for k in (1, 2, 16)]
        errors = [np.abs(double.difference(x.q, exact[2].q)).max() for x in exact[:2]]
        self.assertLess(errors[1], errors[0] / 10)  # of fourth order: 16

    def test_layouts_and_shapes(self):
        f = lambda *a, **k: double.forward_dynamics_rollout(*a, time_step=self.h, **k)
        expected = f(self.Q, self.V, self.TAU)
        same = lambda result, of=slice(None): self.assertEqual([x.tobytes() for x in result], [x[of].tobytes() for x in expected])
        same(f(self.Q, self.V, tau=self.TAU, steps=self.steps))
        same(f(self.Q, self.V, np.asfortranarray(self.TAU)))
        same(f(self.Q, self.V, np.repeat(self.TAU, 2, axis=1)[:, ::2]))
        same(f(self.Q[::-1], self.V[::-1], self.TAU[::-1]), slice(None, None, -1))
        same(f(np.hstack([self.Q, self.Q])[:, :double.nq], self.V, self.TAU.astype(">f8")))
        same(f(self.Q[3], self.V[3], self.TAU[3]), 3)
        self.assertEqual(f(self.Q[3], self.V[3], self.TAU[3], path=True).q.shape, (self.steps, double.nq))
        shared = f(self.Q, self.V, self.TAU[0])
        same(f(self.Q[:1], self.V[:1], self.TAU[0]), slice(0, 1))
        self.assertEqual(shared.q.tobytes(), f(self.Q, self.V, np.broadcast_to(self.TAU[0], self.TAU.shape)).q.tobytes())
        from_one = f(self.Q[0], self.V[0], self.TAU)
        self.assertEqual(from_one.q.tobytes(), f(np.tile(self.Q[0], (self.n, 1)), np.tile(self.V[0], (self.n, 1)), self.TAU).q.tobytes())
        nothing = f(self.Q, self.V, steps=self.steps)
        self.assertEqual(nothing.q.tobytes(), f(self.Q, self.V, np.zeros((self.steps, double.nv))).q.tobytes())
        self.assertEqual(f(self.Q, self.V, steps=0).q.tobytes(), self.Q.tobytes())
        self.assertEqual(f(self.Q, self.V, steps=0, path=True).q.shape, (self.n, 0, double.nq))
        self.assertEqual(f(self.Q[:0], self.V[:0], self.TAU[:0]).q.shape, (0, double.nq))
        out = (np.empty_like(expected.q), np.empty_like(expected.v))
        result = f(self.Q, self.V, self.TAU, out=out)
        self.assertIs(result.q, out[0])
        same(out)
        place = (self.Q.copy(), self.V.copy())
        f(*place, self.TAU, out=place)  # into where the motions begin
        same(place)
        Q, V, TAU = (np.tile(x, (40,) + (1,) * (x.ndim - 1)) for x in (self.Q, self.V, self.TAU))  # enough for threads
        before = dalembert.threads()
        for threads in (1, 2):
            dalembert.threads(threads)
            many = f(Q, V, TAU)
            self.assertEqual(many.q.tobytes(), np.tile(expected.q, (40, 1)).tobytes())
        dalembert.threads(before)

    def test_run_time_inputs(self):
        f = lambda *a, **k: double.forward_dynamics_rollout(*a, time_step=self.h, **k)
        gravity = np.linspace(-9, 3, 3 * self.n).reshape(self.n, 3)
        each = f(self.Q, self.V, self.TAU, gravity_vector=gravity, wrench_link_02=np.ones(6))
        for m in (0, 5, self.n - 1):
            one = f(self.Q[m], self.V[m], self.TAU[m], gravity_vector=gravity[m], wrench_link_02=np.ones(6))
            self.assertEqual((one.q.tobytes(), one.v.tobytes()), (each.q[m].tobytes(), each.v[m].tobytes()))
        self.assertNotEqual(each.q.tobytes(), f(self.Q, self.V, self.TAU).q.tobytes())

    def test_where_it_cannot_go_on_a_motion_stops_alone(self):
        f = lambda tau, **k: arm.forward_dynamics_rollout(self.q, self.v, tau, time_step=self.h, path=True, **k)
        good, bad = f(self.tau), self.tau.copy()
        bad[4, 3] = np.nan
        result, status = f(bad, return_status=True)
        self.assertEqual(status.tolist(), [3 if m == 4 else -1 for m in range(self.n)])
        others = np.arange(self.n) != 4
        self.assertEqual(result.q[others].tobytes(), good.q[others].tobytes())
        self.assertEqual(result.q[4, :3].tobytes(), good.q[4, :3].tobytes())
        self.assertTrue((result.q[4, 3:] == good.q[4, 2]).all())
        with self.assertWarnsRegex(dalembert.StoppedWarning, r"1 of 21 motions stopped, the first of them number 4 in step 3"):
            f(bad)
        _, one = arm.forward_dynamics_rollout(self.q[4], self.v[4], bad[4], time_step=self.h, return_status=True)
        self.assertEqual(one, 3)

    def test_without_batches_in_float32(self):
        """State by state, as integrators of C++ have it: to rounding what batches give."""
        q, v, tau = (x.astype(np.float32) for x in (self.q, self.v, self.tau))
        for method in ("semi_implicit_euler", "rk4"):
            more = dict(time_step=self.h, method=method, path=True)
            result = single.forward_dynamics_rollout(q, v, tau, **more)
            self.assertEqual(result.q.dtype, np.float32)
            for a, b in zip(result, arm.forward_dynamics_rollout(q, v, tau, **more)):
                np.testing.assert_allclose(a, b, rtol=0, atol=1e-4)
        tau[2, 5, 0] = np.inf
        _, status = single.forward_dynamics_rollout(q, v, tau, time_step=self.h, return_status=True)
        self.assertEqual(status.tolist(), [5 if m == 2 else -1 for m in range(self.n)])

    def test_one_array_for_both_results_is_refused(self):
        b = np.zeros((self.n, arm.nv))
        with self.assertRaisesRegex(ValueError, "out's two arrays share memory"):
            arm.forward_dynamics_rollout(self.q, self.v, self.tau, time_step=self.h, out=(b, b))
        both = np.empty((self.n, arm.nq + arm.nv))  # columns of one array do not
        expected = arm.forward_dynamics_rollout(self.q, self.v, self.tau, time_step=self.h)
        arm.forward_dynamics_rollout(self.q, self.v, self.tau, time_step=self.h, out=(both[:, :arm.nq], both[:, arm.nq:]))
        self.assertTrue((both == np.hstack(expected)).all())
        with self.assertRaisesRegex(TypeError, "no argument 'a'"):
            arm.forward_dynamics_rollout(self.q, self.v, a=self.tau, time_step=self.h)

    def test_wrong_ones_are_refused_by_name(self):
        f, Q, V, TAU, nv = double.forward_dynamics_rollout, self.Q, self.V, self.TAU, double.nv
        h = dict(time_step=self.h)
        for error, text, call in (
                (ValueError, rf"forward_dynamics_rollout: q has shape \(21, 8\), expected", lambda: f(Q[:, 1:], V, TAU, **h)),
                (ValueError, rf"tau has shape \({nv},\), expected \(steps, {nv}\) for all motions or \(n, steps, {nv}\)",
                 lambda: f(Q, V, TAU[0, 0], **h)),
                (ValueError, r"tau has shape \(21, 7, 1\)", lambda: f(Q, V, TAU[:, :, :1], **h)),
                (ValueError, r"tau has dtype <U1", lambda: f(Q, V, np.full(TAU.shape, "a"), **h)),
                (ValueError, r"q has 21 motions and tau has 5", lambda: f(Q, V, TAU[:5], **h)),
                (ValueError, r"tau has 7 steps, and `steps` is 6", lambda: f(Q, V, TAU, steps=6, **h)),
                (ValueError, r"steps is -1, expected", lambda: f(Q, V, steps=-1, **h)),
                (ValueError, r"steps is 1.5, expected", lambda: f(Q, V, steps=1.5, **h)),
                (ValueError, r"3000000000 steps are more", lambda: f(Q, V, steps=3_000_000_000, **h)),
                (TypeError, r"needs steps, or tau", lambda: f(Q, V, **h)),
                (TypeError, r"time_step", lambda: f(Q, V, TAU)),
                (TypeError, r"time_step is of type str", lambda: f(Q, V, TAU, time_step="a")),
                (ValueError, r"time_step is not a finite", lambda: f(Q, V, TAU, time_step=np.nan)),
                (ValueError, r"no method 'rk45'; did you mean 'rk4'", lambda: f(Q, V, TAU, method="rk45", **h)),
                (TypeError, r"has no argument 'a'; there are q, v, tau, gravity_vector", lambda: f(Q, V, TAU, a=1, **h)),
                (TypeError, r"tau once", lambda: f(Q, V, TAU, tau=TAU, **h)),
                (ValueError, r"out has shape \(21, 9\), expected \(21, 7, 9\)", lambda: f(Q, V, TAU, path=True, out=(Q, V), **h)),
                (ValueError, r"out has 1 arrays", lambda: f(Q, V, TAU, out=(Q,), **h)),
                (ValueError, r"gravity_vector has 2 states", lambda: f(Q, V, TAU, gravity_vector=np.ones((2, 3)), **h)),
                (AttributeError, r"loaded without 'constrained_forward_dynamics', which 'constrained_forward_dynamics_rollout' needs",
                 lambda: single.constrained_forward_dynamics_rollout)):
            with self.subTest(text=text), self.assertRaisesRegex(error, text):
                call()
        self.assertIn("time_step", inspect.signature(f).parameters)
        self.assertIn("(steps, 8) for all motions", f.__doc__)


class ConstraintStatuses(unittest.TestCase):
    """What solving for rows came to, of which some say what others say."""

    @classmethod
    def setUpClass(cls):
        cls.robot = dalembert.load(robots.robot("double_pendulum"), base="floating", flags=robots.quick, batch=False,
                                   outputs=["mass_matrix", "constrained_forward_dynamics", "constraint_forces", "impact",
                                            "constrained_inverse_dynamics"],
                                   contacts={"held": {"link": "link_02", "type": "weld"},
                                             "again": {"link": "link_02", "type": "point", "at": [0.1, 0, 0]}})
        rng = np.random.default_rng(8)
        n = 5
        cls.Q, (cls.V, cls.TAU) = cls.robot.random(rng, n), rng.uniform(-1, 1, (2, n, cls.robot.nv))

    def test_of_one_state_and_of_many(self):
        r, (q, v, tau) = self.robot, (self.Q, self.V, self.TAU)
        for function, arguments in ((r.constrained_forward_dynamics, (q, v, tau)), (r.impact, (q, v)),
                                    (r.constrained_inverse_dynamics, (q, v, tau))):
            results, many = function(*arguments, return_constraint_status=True)
            np.testing.assert_allclose(results, function(*arguments), rtol=0, atol=1e-9 * np.abs(results).max())
            self.assertIsInstance(many, dalembert.ConstraintStatus)
            self.assertEqual([x.shape for x in many], [(len(q),)] * 3)
            self.assertEqual(many.rank.tolist(), [6] * len(q))
            for s in range(len(q)):
                result, status, one = function(*(x[s] for x in arguments), return_status=True, return_constraint_status=True)
                self.assertEqual(result.tobytes(), results[s].tobytes())
                self.assertEqual(status, -1)
                self.assertEqual((one.residual, one.least_pivot, one.rank), tuple(x[s] for x in many))
        free = np.zeros_like(v)  # speeds that do not contradict the rows
        told = r.constrained_forward_dynamics(q, free, tau, return_constraint_status=True)[1]
        self.assertLess(told.residual.max(), 1e-9)
        self.assertLess(told.least_pivot.max(), 1e-6)
        alone = r.constrained_forward_dynamics(q, free, tau, contact_again=dalembert.Contact(active=False), return_constraint_status=True)[1]
        self.assertGreater(alone.least_pivot.min(), 1e-6)
        self.assertEqual(alone.rank.tolist(), [6] * len(q))

    def test_weights_that_are_none(self):
        """By their ratio alone; a negative one counts as zero and is told, or refused where it is given as a whole."""
        r, (q, v, a) = self.robot, (self.Q[0], self.V[0], self.TAU[0])
        off = dict(contact_again=dalembert.Contact(active=False), return_constraint_status=True)
        expected, _ = r.constrained_inverse_dynamics(q, v, a, **off)
        for weight in (1e-308, 1e300):
            tau, told = r.constrained_inverse_dynamics(q, v, a, contact_held=dalembert.Contact(weight=(weight,) * 6), **off)
            np.testing.assert_allclose(tau, expected, rtol=0, atol=1e-9 * np.abs(expected).max())
            self.assertEqual(told.rank, 6)
        again = copy.deepcopy(r)
        again.contact_held[18] = -1
        tau, told = again.constrained_inverse_dynamics(q, v, a, return_constraint_status=True)
        self.assertTrue(np.isfinite(tau).all())
        self.assertEqual(told.least_pivot, -1)

    def test_numbers_that_cannot_hold_are_refused(self):
        r, (q, v, tau) = copy.deepcopy(self.robot), (self.Q[0], self.V[0], self.TAU[0])
        Contact, inf, nan = dalembert.Contact, np.inf, np.nan
        with_last = lambda x: (1, 1, 1, 1, 1, x)
        before = r.contact_held.tolist()
        for text, contact in (
                (r"contact_held: kp is inf, expected a finite number", Contact(kp=inf)), (r"kd is nan", Contact(kd=nan)),
                (r"active is nan, expected true or false", Contact(active=nan)), (r"active is 0.5, expected true", Contact(active=0.5)), (r"restitution is -inf", Contact(restitution=-inf)),
                (r"anchor\[2\] is inf", Contact(anchor=(0, 0, inf, 0, 0, 0, 1))),
                (r"anchor\[6\] is 0.0, expected a quaternion x y z w in anchor\[3\]", Contact(kp=1, anchor=(0,) * 7)),
                (r"regularization\[5\] is inf, expected a finite number, zero or more", Contact(regularization=with_last(inf))),
                (r"regularization\[5\] is -0.1", Contact(regularization=with_last(-0.1))),
                (r"anchor of Contact has 3 numbers, expected 7", Contact(anchor=(0, 0, 0))),
                (r"regularization of Contact has 1 number, expected 6", Contact(regularization=-1)),
                (r"kp of Contact has 2 numbers, expected 1", Contact(kp=(1, 2))),
                (r"weight\[5\] is nan", Contact(weight=with_last(nan))), (r"weight\[5\] is -1.0", Contact(weight=with_last(-1)))):
            with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                r.contact_held = contact
            if " of Contact has " in text:
                with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                    r.constrained_forward_dynamics(q, v, tau, contact_held=contact)
                continue
            with self.subTest(text), self.assertRaisesRegex(ValueError, "^constrained_forward_dynamics: contact_held: "):
                r.constrained_forward_dynamics(q, v, tau, contact_held=contact)
        self.assertEqual(r.contact_held.tolist(), before)
        with self.assertRaisesRegex(ValueError, r"contact_held: kp of state 1 is inf"):
            r.constrained_forward_dynamics(self.Q[:2], v, tau, contact_held=[Contact(), Contact(kp=inf)])
        with self.assertRaisesRegex(ValueError, r"contact_again: weight\[2\] is inf"):
            r.contact_again = Contact(weight=(1, 1, inf, inf, inf, inf))
        with self.assertRaisesRegex(ValueError, "anchor of Contact has 3 numbers"):  # a point's too, whose rows would make up for it
            r.contact_again = Contact(anchor=(0, 0, 0))
        r.contact_held = Contact(active=False, kp=nan, weight=(-1,) * 6)  # what is off holds nothing
        r.contact_again = Contact(anchor=(0,) * 7)  # a point has no turn
        self.assertTrue(np.isfinite(r.constrained_forward_dynamics(q, v, tau)).all())

    def test_of_several_quantities(self):
        r, at = self.robot, (self.Q, self.V)
        names = ["constrained_forward_dynamics", "constraint_forces"]
        values, status, told = r.evaluate(*at, tau=self.TAU, outputs=names, return_status=True, return_constraint_status=True)
        self.assertEqual(values._fields, tuple(names))
        self.assertEqual((status.tolist(), told.rank.tolist()), ([-1] * 5, [6] * 5))
        with self.assertRaisesRegex(TypeError, "the quantities of one function"):
            r.evaluate(*at, tau=self.TAU, outputs=["impact", "constraint_forces"], return_constraint_status=True)

    def test_only_where_rows_are_solved_for(self):
        r = self.robot
        self.assertTrue(r.impact.has_constraint_status)
        self.assertIn("return_constraint_status", str(r.impact.__signature__) + r.impact.__doc__)
        self.assertFalse(r.mass_matrix.has_constraint_status)
        self.assertNotIn("return_constraint_status", r.mass_matrix.__doc__)
        with self.assertRaisesRegex(TypeError, "no argument 'return_constraint_status'"):
            r.mass_matrix(self.Q, return_constraint_status=True)


class SwitchedContacts(unittest.TestCase):
    """Contacts and loops that come on and go in rollouts, with impacts."""

    @classmethod
    def setUpClass(cls):
        cls.hold = dict(base="floating", gravity="run_time", flags=robots.quick, batch=False,
                        contacts={"left": {"link": "a_02", "type": "point", "at": [0.1, 0, 0]}, "b_02": "point"},
                        loops={"rod": {"links": ["a_01", "b_01"], "at": [[0, 0, 0.1], [0, 0.1, 0]], "type": "distance",
                                       "length": 0.5}})
        cls.robot = dalembert.load(robots.robot("two_branches_at_base"), outputs=["constrained_forward_dynamics"],
                                   functions={"struck": ["constrained_forward_dynamics", "impact"], "strike": ["impact"]}, **cls.hold)

    def setUp(self):
        rng = np.random.default_rng(31)
        self.n, self.steps, self.h = 19, 6, 0.01
        self.Q, self.V = self.robot.random(rng, self.n), rng.uniform(-1, 1, (self.n, self.robot.nv))
        self.TAU = rng.uniform(-1, 1, (self.n, self.steps, self.robot.nv))
        self.active = rng.integers(0, 2, (self.n, self.steps, 3)).astype(bool)
        self.given = dict(contact_left=dalembert.Contact(restitution=0.4), gravity_vector=[0, 0, -1.62])

    def expected(self):
        """Step by step, one call each."""
        robot, q, v = self.robot, self.Q, self.V
        before = np.ones(self.active[:, 0].shape, bool)  # as the run-time inputs have them
        for step in range(self.steps):
            acts, held = self.active[:, step], []
            for m in range(self.n):
                left, right, rod = (bool(x) for x in acts[m])
                held.append(dict(contact_left=dalembert.Contact(left, restitution=0.4), contact_b_02=dalembert.Contact(right),
                                 loop_rod=dalembert.Loop(rod), gravity_vector=[0, 0, -1.62]))
            struck = (acts & ~before).any(1)
            v = np.array([robot.strike(q[m], v[m], **held[m]).impact if struck[m] else v[m] for m in range(self.n)])
            v = v + self.h * np.array([robot.constrained_forward_dynamics(q[m], v[m], self.TAU[m, step], **held[m])
                                       for m in range(self.n)])
            q = robot.integrate(q, self.h * v)
            before = acts
        return q, v

    def test_impacts_where_one_comes_on(self):
        robot, (q, v) = self.robot, self.expected()
        switched = dict(time_step=self.h, **self.given)
        # By another function that tells what an impact does, by its own, and from one array for all motions.
        for roll_out in (robot.constrained_forward_dynamics_rollout, robot.struck_rollout):
            for active in (self.active, self.active.astype(float), np.asfortranarray(self.active)):
                end = roll_out(self.Q, self.V, self.TAU, active=active, **switched)
                np.testing.assert_allclose(end.q, q, rtol=0, atol=1e-11)
                np.testing.assert_allclose(end.v, v, rtol=0, atol=1e-11 * np.abs(v).max())
        one = robot.struck_rollout(self.Q[4], self.V[4], self.TAU[4], active=self.active[4], path=True, **switched)
        np.testing.assert_allclose(one.q[-1], q[4], rtol=0, atol=1e-11)
        for_all = robot.struck_rollout(self.Q, self.V, active=self.active[4], **switched)
        each = robot.struck_rollout(self.Q, self.V, active=self.active[[4] * self.n], **switched)
        self.assertEqual(for_all.v.tobytes(), each.v.tobytes())
        for_each = dict(switched, contact_left=[dalembert.Contact(restitution=0.4)] * self.n)
        np.testing.assert_array_equal(robot.struck_rollout(self.Q, self.V, self.TAU, active=self.active, **for_each).v,
                                      robot.struck_rollout(self.Q, self.V, self.TAU, active=self.active, **switched).v)
        # What acts all the time is not struck.
        always = robot.struck_rollout(self.Q, self.V, self.TAU, active=np.ones((self.steps, 3)), **switched)
        without = robot.struck_rollout(self.Q, self.V, self.TAU, **switched)
        self.assertEqual(always.v.tobytes(), without.v.tobytes())
        self.assertFalse(np.allclose(always.v, v))

    def test_a_motion_that_stops_keeps_what_it_had_before_the_impact(self):
        self.active[:] = [True, False, False]
        self.TAU[3, 2, 0] = np.nan
        start = dict(contact_left=dalembert.Contact(active=False))
        end, stopped = self.robot.struck_rollout(self.Q, self.V, self.TAU, active=self.active, time_step=self.h, return_status=True, **start)
        path = self.robot.struck_rollout(self.Q[3], self.V[3], self.TAU[3, :2], active=self.active[3, :2], time_step=self.h, **start)
        self.assertEqual(stopped.tolist(), [2 if m == 3 else -1 for m in range(self.n)])
        self.assertEqual(end.v[3].tobytes(), path.v.tobytes())
        self.active[3, :2] = False  # now what comes on in the step that it cannot make is an impact, too
        end, stopped = self.robot.struck_rollout(self.Q, self.V, self.TAU, active=self.active, time_step=self.h, return_status=True, **start)
        path = self.robot.struck_rollout(self.Q[3], self.V[3], self.TAU[3, :2], active=self.active[3, :2], time_step=self.h, **start)
        self.assertEqual((stopped[3], end.v[3].tobytes()), (2, path.v.tobytes()))

    def test_wrong_ones_are_refused_by_name(self):
        f, h = self.robot.constrained_forward_dynamics_rollout, dict(time_step=self.h)
        deaf = dalembert.load(robots.robot("two_branches_at_base"), outputs=["constrained_forward_dynamics"], **self.hold)
        for error, text, call in (
                (ValueError, r"active has shape \(19, 6, 2\), expected \(steps, 3\) for all motions or \(n, steps, 3\)",
                 lambda: f(self.Q, self.V, self.TAU, active=self.active[:, :, :2], **h)),
                (ValueError, r"active is 0.5 somewhere, expected true or false",
                 lambda: f(self.Q, self.V, self.TAU, active=0.5 * self.active, **h)),
                (ValueError, r"active has 5 steps, and tau has 6", lambda: f(self.Q, self.V, self.TAU, active=self.active[:, :5], **h)),
                (ValueError, r"active has 6 steps, and `steps` is 7", lambda: f(self.Q, self.V, active=self.active, steps=7, **h)),
                (ValueError, r"q has 19 motions and active has 5", lambda: f(self.Q, self.V, active=self.active[:5], **h)),
                (ValueError, r"active has dtype <U1", lambda: f(self.Q, self.V, active=np.full((6, 3), "a"), **h)),
                (TypeError, r"needs steps, or tau", lambda: f(self.Q, self.V, **h)),
                (TypeError, r"no argument 'activ'; .*, active, steps", lambda: f(self.Q, self.V, self.TAU, activ=self.active, **h)),
                (ValueError, r"add 'impact' to outputs",
                 lambda: deaf.constrained_forward_dynamics_rollout(self.Q, self.V, active=self.active, **h)),
                (TypeError, r"no argument 'active'", lambda: double.forward_dynamics_rollout(
                    double.neutral(), np.zeros(double.nv), steps=1, active=self.active[0], **h))):
            with self.subTest(text=text), self.assertRaisesRegex(error, text):
                call()
        self.assertIn("(steps, 3) for all motions", f.__doc__)
        self.assertIn("active", inspect.signature(f).parameters)


class Shapes(unittest.TestCase):
    def setUp(self):
        rng = np.random.default_rng(5)
        self.Q, self.V, self.TAU = double.random(rng, 6), rng.uniform(-1, 1, (6, double.nv)), rng.uniform(-1, 1, (6, double.nv))

    def test_wrong_ones_are_refused_by_name(self):
        q, v, tau, nq, nv = self.Q[0], self.V[0], self.TAU[0], double.nq, double.nv
        f, M = double.forward_dynamics, double.mass_matrix
        for error, text, call in (
                (ValueError, rf"mass_matrix: q has shape \({nq - 1},\), expected \({nq},\) for one state or \(n, {nq}\)", lambda: M(q[:-1])),
                (ValueError, r"q has shape \(\)", lambda: M(1.0)),
                (ValueError, r"q has shape \(2, 3, 9\)", lambda: M(np.zeros((2, 3, 9)))),
                (ValueError, r"q has shape \(0,\)", lambda: M([])),
                (ValueError, r"q has dtype complex128, expected float64", lambda: M(q + 0j)),
                (ValueError, r"q has dtype <U", lambda: M(["a"] * nq)),
                (ValueError, r"q has dtype object", lambda: M(np.array([None] * nq))),
                (ValueError, r"forward_dynamics: tau has shape", lambda: f(q, v, tau[1:])),
                (ValueError, r"forward_dynamics: v has shape", lambda: f(q, q, tau)),
                (ValueError, r"q has 6 states and v has 5", lambda: f(self.Q, self.V[:5], tau)),
                (ValueError, r"wrench_link_02 has shape \(5,\), expected \(6,\)", lambda: f(q, v, tau, wrench_link_02=np.zeros(5))),
                (ValueError, r"wrench_link_02 has 3 states", lambda: f(self.Q, v, tau, wrench_link_02=np.zeros((3, 6)))),
                (TypeError, r"forward_dynamics needs tau", lambda: f(q, v)),
                (TypeError, r"forward_dynamics needs v", lambda: f(q)),
                (TypeError, r"mass_matrix needs q", lambda: M()),
                (TypeError, r"takes q, v, tau, and 4 arguments were given", lambda: f(q, v, tau, tau)),
                (TypeError, r"has no argument 'a'; there are q, v, tau, gravity_vector", lambda: f(q, v, a=tau)),
                (TypeError, r"'v' is given twice", lambda: f(q, v, tau, v=v)),
                (ValueError, rf"out has shape \(2, 2\), expected \({nv}, {nv}\)", lambda: M(q, out=np.empty((2, 2)))),
                (ValueError, r"out has dtype float32, expected float64", lambda: M(q, out=np.empty((nv, nv), np.float32))),
                (ValueError, r"out is of type list", lambda: M(q, out=[0])),
                (ValueError, r"out has 1 arrays, expected one for each of 3 results", lambda: double.both(q, v, out=(q,))),
                (ValueError, r"out is one array, expected a tuple of 3", lambda: double.both(q, v, out=q)),
                (KeyError, r"there is no quantity 'mass_matrx'; did you mean 'mass_matrix'", lambda: double["mass_matrx"]),
                (KeyError, r"was loaded without 'gravity'", lambda: double.evaluate(q, v, outputs=["gravity"])),
                (AttributeError, r"was loaded without 'gravity'", lambda: double.gravity),
                (AttributeError, r"cannot be set; did you mean 'gravity_vector'", lambda: setattr(double, "gravity_vectr", 0)),
                (ValueError, r"gravity_vector has shape \(2,\)", lambda: setattr(double, "gravity_vector", [0, 0])),
        ):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()
        read_only = np.empty((nv, nv))
        read_only.flags.writeable = False
        with self.assertRaisesRegex(ValueError, "out is read-only"):
            M(q, out=read_only)

    def test_other_layouts_give_the_same(self):
        M, f, Q, V, TAU = double.mass_matrix, double.forward_dynamics, self.Q, self.V, self.TAU
        expected, accelerations, of_one = M(Q), f(Q, V, TAU), M(Q[2])
        wide = np.zeros((12, 3 * double.nq))
        wide[::2, ::3] = Q
        read_only = Q.copy()
        read_only.flags.writeable = False
        unaligned = np.frombuffer(b"x" + Q.tobytes(), np.uint8)[1:].view()
        unaligned = np.ndarray(Q.shape, np.float64, unaligned.data)
        for name, other in (("strides", wide[::2, ::3]), ("Fortran", np.asfortranarray(Q)), ("read-only", read_only),
                            ("byte order", Q.astype(Q.dtype.newbyteorder())), ("list", Q.tolist()), ("unaligned", unaligned),
                            ("longdouble", Q.astype(np.longdouble)), ("subclass", Q.view(np.recarray)), ("matrix", np.matrix(Q))):
            with self.subTest(name):
                self.assertTrue(np.array_equal(M(other), expected))
                self.assertTrue(np.array_equal(M(np.asarray(other)[2]), of_one))
        self.assertTrue(np.array_equal(M(Q[::-1]), expected[::-1]))
        self.assertTrue(np.array_equal(M(np.broadcast_to(Q[1], Q.shape)), expected[[1] * 6]))
        self.assertTrue(np.array_equal(f(Q, v=V, tau=TAU), accelerations))
        self.assertTrue(np.array_equal(M(np.ones(double.nq, int)), M(np.ones(double.nq))))
        self.assertTrue(np.array_equal(M(Q, V), expected))  # v is not read, and may stand there

    def test_out(self):
        M, Q = double.mass_matrix, self.Q
        expected, nv = M(Q), double.nv
        for out in (np.empty_like(expected), np.asfortranarray(np.empty_like(expected)), np.empty((6, nv, 2 * nv))[:, :, ::2],
                    np.empty_like(expected, dtype=expected.dtype.newbyteorder())):
            self.assertIs(M(Q, out=out), out)
            self.assertTrue(np.array_equal(out, expected))
        one = np.full((nv, nv), np.nan)
        self.assertIs(M(Q[0], out=one), one)
        self.assertTrue(np.array_equal(one, M(Q[0])))
        # Results that share memory with an argument.
        memory = np.zeros(6 * nv * nv)
        shared = memory[-6 * double.nq:].reshape(6, double.nq)
        shared[:] = Q
        self.assertTrue(np.array_equal(M(shared, out=memory.reshape(6, nv, nv)), expected))
        v = self.V.copy()
        expected = double.forward_dynamics(Q, v, self.TAU)
        self.assertTrue(np.array_equal(double.forward_dynamics(Q, v, self.TAU, out=v), expected))
        energy = np.empty(())
        self.assertIs(double.kinetic_energy(Q[0], self.V[0], out=energy), energy)
        self.assertEqual(energy, double.kinetic_energy(Q[0], self.V[0]))
        outs = tuple(np.empty_like(x) for x in double.both(Q, self.V))
        for given, back in zip(outs, double.both(Q, self.V, out=outs)):
            self.assertIs(given, back)
        for names in (["mass_matrix", "kinetic_energy"], ["kinetic_energy", "mass_matrix"]):  # whatever the function's own order is
            outs = [np.empty_like(getattr(double.evaluate(Q, self.V), name)) for name in names]
            results = double.evaluate(Q, self.V, outputs=names, out=outs)
            for name, given, back in zip(names, outs, results):
                self.assertIs(given, back)
                self.assertEqual(given.tobytes(), getattr(double.evaluate(Q, self.V), name).tobytes())

    def test_evaluate_gives_what_its_arguments_give(self):
        q, v, a = self.Q[0], self.V[0], self.TAU[0]
        self.assertEqual(set(double.evaluate(q, v, a=a, tau=a)._fields), {"inverse_dynamics", "forward_dynamics"})
        with self.assertRaisesRegex(TypeError, "inverse_dynamics needs v"):
            double.evaluate(q, a=a)
        with self.assertRaisesRegex(KeyError, "'both' is a function of the scene, and not a quantity: call robot"):
            double.evaluate(q, v, outputs=["both"])

    def test_results_are_the_callers(self):
        first = double.mass_matrix(self.Q[0])
        copied = first.copy()
        double.mass_matrix(self.Q[1])
        self.assertTrue(np.array_equal(first, copied))
        self.assertTrue(first.flags.owndata and first.flags.c_contiguous and first.flags.writeable)

    def test_none_many_and_not_a_number(self):
        nq, nv = double.nq, double.nv
        self.assertEqual(double.mass_matrix(np.empty((0, nq))).shape, (0, nv, nv))
        self.assertEqual(double.kinetic_energy(np.empty((0, nq)), np.empty((0, nv))).shape, (0,))
        with self.assertRaises((MemoryError, ValueError)):
            double.mass_matrix(np.broadcast_to(self.Q[0], (10**15, nq)))
        q = self.Q[0].copy()
        q[8] = np.nan
        self.assertTrue(np.isnan(double.mass_matrix(q)).any())
        with self.assertRaisesRegex(ValueError, r"forward_dynamics: q\[8\] is nan"):
            double.forward_dynamics(q, self.V[0], self.TAU[0])

    def test_a_named_tuple(self):
        results = double.both(self.Q, self.V)
        self.assertEqual(results._fields, ("bias", "center_of_mass", "pose_link_02"))
        self.assertEqual(results.pose_link_02.shape, (6, 3, 4))
        self.assertTrue(np.array_equal(pickle.loads(pickle.dumps(results)).bias, results.bias))
        some = double.evaluate(self.Q, self.V, tau=self.TAU, outputs=["forward_dynamics", "mass_matrix"])
        self.assertEqual(some._fields, ("forward_dynamics", "mass_matrix"))
        self.assertTrue(np.array_equal(some.forward_dynamics, double.forward_dynamics(self.Q, self.V, self.TAU)))
        self.assertIsInstance(double.kinetic_energy(self.Q[0], self.V[0]), float)
        # A scene's function that is called like a method of ours leaves that alone.
        self.assertTrue(callable(double.info) and not isinstance(double.info, type(double.both)))
        self.assertTrue(np.array_equal(double["info"](self.Q, self.V).bias, results.bias))

    def test_single_precision(self):
        q, v = np.array([0.1, 0.2]), np.array([0.3, 0.4])
        M = single.mass_matrix(q)
        self.assertEqual(M.dtype, np.float32)
        self.assertTrue(np.array_equal(M, single.mass_matrix(q.astype(np.float32))))
        self.assertEqual(single.random(3).dtype, np.float32)
        self.assertEqual(single.bias(np.tile(q, (3, 1)), v).shape, (3, 2))


class RunTime(unittest.TestCase):
    def setUp(self):
        self.robot = copy.deepcopy(double)
        rng = np.random.default_rng(6)
        self.Q, self.V, self.A = self.robot.random(rng, 4), rng.uniform(-1, 1, (4, self.robot.nv)), np.zeros((4, self.robot.nv))

    def test_of_more_states_than_there_is_memory_for(self):
        """Refused before any of them is looked at."""
        many = lambda x: np.broadcast_to(x, (10**15, len(x)))
        r, (q, v, a) = self.robot, (self.Q[0], self.V[0], self.A[0])
        for given in (dict(gravity_vector=many([0.0, 0, -1])), dict(wrench_link_02=many(np.zeros(6)), gravity_vector=many([0.0, 0, -1]))):
            for call in (lambda: r.inverse_dynamics(many(q), v, a, **given), lambda: r.inverse_dynamics(q, v, a, **given),
                         lambda: r.evaluate(many(q), many(v), tau=many(a), **given),
                         lambda: r.forward_dynamics_rollout(many(q), v, a[None], time_step=0.1, **given),
                         lambda: r.forward_dynamics_rollout(q, v, a[None], time_step=0.1, **given)):
                self.assertRaises(MemoryError, call)
            with self.assertRaisesRegex(ValueError, f"has {10**15} states, and other arguments have 4"):
                r.inverse_dynamics(self.Q, v, a, **given)
        self.assertRaises(MemoryError, lambda: r.mass_matrix(many(q)))

    def test_attributes_and_per_state(self):
        r, Q, V, A = self.robot, self.Q, self.V, self.A
        before = r.inverse_dynamics(Q, V, A)
        r.gravity_vector = [0, 0, -1.62]
        moon = r.inverse_dynamics(Q, V, A)
        self.assertFalse(np.allclose(before, moon))
        r.gravity_vector[2] = -9.81  # a view
        self.assertTrue(np.array_equal(r.inverse_dynamics(Q, V, A), before))
        G = np.array([[0, 0, -9.81], [0, 0, -1.62]] * 2)
        mixed = r.inverse_dynamics(Q, V, A, gravity_vector=G)
        self.assertTrue(np.array_equal(mixed[::2], before[::2]) and np.array_equal(mixed[1::2], moon[1::2]))
        self.assertTrue(np.array_equal(r.inverse_dynamics(Q[:1], V[0], A[0], gravity_vector=G[1]), moon[:1]))
        self.assertTrue(np.allclose(r.inverse_dynamics(Q[0], V[0], A[0], gravity_vector=G[1]), moon[0], rtol=1e-13))
        # One state, many gravities.
        self.assertTrue(np.array_equal(r.inverse_dynamics(Q[1], V[1], A[1], gravity_vector=G[:2])[1], moon[1]))
        self.assertTrue(np.array_equal(r.inverse_dynamics(Q, V, A), before))  # the robot's own is as it was
        # A wrench is minus J'F, whose part along the base is the wrench itself as momentum has it: forces add up.
        push = r.inverse_dynamics(Q, V, A, wrench_link_02=[0, 0, 5, 0, 0, 0]) - before
        self.assertTrue(np.allclose(np.linalg.norm(push[:, :3], axis=1), 5))
        r.payload_link_02 = dalembert.Payload(mass=2, com=(0.1, 0, 0), inertia=(0.01, 0, 0, 0.01, 0, 0.01))
        self.assertTrue(np.allclose(r.payload_link_02, [2, 0.1, 0, 0, 0.01, 0, 0, 0.01, 0, 0.01]))
        self.assertFalse(np.allclose(r.inverse_dynamics(Q, V, A), before))
        again = pickle.loads(pickle.dumps(r))
        self.assertTrue(np.array_equal(again.inverse_dynamics(Q, V, A), r.inverse_dynamics(Q, V, A)))
        self.assertTrue(np.array_equal(double.inverse_dynamics(Q, V, A), before))  # a copy has its own

    def test_singular_states(self):
        q, v, tau = np.array([0.3, 0.5]), np.zeros(2), np.ones(2)
        light = np.zeros((3, 10))
        light[1, 0] = -1e3  # a mass below zero
        with self.assertRaisesRegex(dalembert.SingularError, r"forward_dynamics: the mass matrix is not positive definite .* joint"):
            arm.forward_dynamics(q, v, tau, payload_link_02=light[1])
        result, status = arm.forward_dynamics(q, v, tau, payload_link_02=light[1], return_status=True)
        self.assertTrue((result == 0).all() and status >= 0)
        with self.assertWarnsRegex(dalembert.SingularWarning, "at 1 of 3 states, the first of them number 1"):
            arm.forward_dynamics(q, v, tau, payload_link_02=light)
        result, status = arm.forward_dynamics(q, v, tau, payload_link_02=light, return_status=True)
        self.assertEqual(list(status >= 0), [False, True, False])
        self.assertEqual(list((result == 0).all(axis=1)), [False, True, False])
        light[1, 0] = np.nan
        with self.assertRaisesRegex(ValueError, r"forward_dynamics: payload_link_02\[0\] of state 1 is nan, expected a finite number"):
            arm.forward_dynamics(q, v, tau, payload_link_02=light)
        with self.assertRaisesRegex(ValueError, r"^payload_link_02\[0\] is nan, expected a finite number"):
            arm.payload_link_02 = light[1]
        self.assertEqual(arm.forward_dynamics(q, v, tau, return_status=True)[1], -1)
        self.assertTrue(issubclass(dalembert.SingularError, ArithmeticError))


class States(unittest.TestCase):
    def test_on_their_group(self):
        r, rng = double, np.random.default_rng(7)
        Q, P = r.random(rng, 50), r.random(rng, 50)
        step = r.difference(Q, P)
        back = r.integrate(Q, step)
        flip = np.sign((back[:, 3:7] * P[:, 3:7]).sum(axis=1))[:, None]  # a quaternion and its negative are one orientation
        back[:, 3:7] *= flip
        self.assertLess(np.abs(back - P).max(), 1e-13)
        self.assertLess(np.abs(np.linalg.norm(step[:, 3:6], axis=1)).max(), np.pi + 1e-12)
        self.assertLess(np.abs(r.interpolate(Q, P, 0) - Q).max(), 1e-14)
        half = r.interpolate(Q, P, 0.5)
        self.assertLess(np.abs(r.difference(Q, half) - step / 2).max(), 1e-13)
        self.assertEqual(r.interpolate(Q[0], P[0], [0, 0.5, 1]).shape, (3, r.nq))
        self.assertTrue(np.array_equal(r.integrate(Q[0], step[0]), r.integrate(Q, step)[0]))
        small = r.integrate(Q, 1e-9 * step)
        self.assertLess(np.abs(r.difference(Q, small) - 1e-9 * step).max(), 1e-15)
        # dT/dt of the energy by differences along the group: the motion is v's.
        v = rng.uniform(-1, 1, r.nv)
        pose = lambda q: r.both(q, v).center_of_mass
        h = 1e-6
        rate = (pose(r.integrate(Q[0], h * v)) - pose(r.integrate(Q[0], -h * v))) / (2 * h)
        free = r.integrate(Q[0], 0 * v)
        self.assertTrue(np.isfinite(rate).all() and np.allclose(free, Q[0], atol=1e-15))
        for wrong in (lambda: r.integrate(Q, step[:3]), lambda: r.integrate(Q[0], [0]), lambda: r.difference(Q, ["a"])):
            self.assertRaises(ValueError, wrong)

    def test_joints_that_follow_are_refused(self):
        """Loops embedded: what moves all of q would leave the dependent joints behind; toggle points are told."""
        rod = {"links": ["slider", "rod"], "at": [[0, 0, 0], [0.5, 0, 0]], "type": "pin", "independent": ["crank_turn"]}
        crank = dalembert.load(robots.project / "tests/numeric/generated/mechanisms/slider_crank.urdf", base="fixed", batch=False,
                               outputs=["forward_dynamics"], loops={"pin": rod}, flags=robots.quick)
        self.assertEqual((crank.nq, crank.nv, crank.joint_names), (3, 1, ("crank_turn",)))
        # A rod across the slider's way does not tell where it goes: linkage 0, behind the one coordinate.
        tau, across, well = np.ones(1), np.array([0.3, np.pi / 2 - 0.3, 0.2]), np.array([0.3, -0.1, 0.6])
        with self.assertRaisesRegex(dalembert.SingularError, "linkage 0 .* toggle point"):
            crank.forward_dynamics(across, np.zeros(1), tau)
        result, status = crank.forward_dynamics(across, np.zeros(1), tau, return_status=True)
        self.assertEqual((result[0], status), (0, 1))
        self.assertEqual(crank.forward_dynamics(well, np.zeros(1), tau, return_status=True)[1], -1)
        with self.assertWarnsRegex(dalembert.SingularWarning, "toggle points at 1 of 2 states, the first of them number 1: all"):
            crank.forward_dynamics([well, across], np.zeros((2, 1)), tau)
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            crank.forward_dynamics([well, across, np.nan * well, across], np.zeros((4, 1)), np.ones((4, 1)))
        for words in ("toggle points at 2 of 4 states, the first of them number 1", "positive definite at 1 of 4 .* number 2, whose q is not finite"):
            self.assertTrue(any(re.search(words, str(s.message)) for s in said), words)
        q, v = crank.neutral(), np.zeros(1)
        for wrong in (crank.random, lambda: crank.integrate(q, v), lambda: crank.difference(q, q), lambda: crank.interpolate(q, q, 0.5),
                      lambda: crank.forward_dynamics_rollout(q, v, time_step=1e-3, steps=3)):
            with self.assertRaisesRegex(NotImplementedError, "close_loops"):
                wrong()

        # What the C function makes of it, of one state and of n; independent positions and what is given stay.
        given = well.copy()
        closed, status = crank.close_loops(given, return_status=True)
        generated = robots.CFunctions(crank.source, batches=False, flags=robots.quick)
        by_c = given.copy()
        self.assertEqual(generated.call_loops(by_c), -1)
        np.testing.assert_allclose(closed, by_c, rtol=0, atol=1e-14)
        self.assertEqual((given.tolist(), closed[0]), (well.tolist(), well[0]))
        self.assertGreater(np.abs(closed - well).max(), 1e-3)
        self.assertIsInstance(status, dalembert.LinkageStatus)
        self.assertLess(status.error, 1e-14)
        self.assertGreater(status.least_pivot, 0.1)
        self.assertEqual(status.linkage, -1)
        self.assertEqual(crank.close_loops(list(well)).tolist(), closed.tolist())
        turned = np.array([[0.3 + 0.1 * i, *closed[1:]] for i in range(4)])
        many, of_many = crank.close_loops(turned, return_status=True)
        self.assertEqual([a.tolist() for a in many], [crank.close_loops(row).tolist() for row in turned])
        self.assertEqual((many[0].tolist(), of_many.linkage.tolist(), of_many.error.shape), (closed.tolist(), [-1] * 4, (4,)))
        self.assertEqual(crank.close_loops(np.empty((0, 3))).shape, (0, 3))
        with self.assertRaisesRegex(dalembert.SingularError, "close_loops: linkage 0 .* toggle point"):
            crank.close_loops(across)
        self.assertEqual(crank.close_loops(across, return_status=True)[1].linkage, 0)
        with self.assertWarnsRegex(dalembert.SingularWarning, "toggle points at 1 of 2 states, the first of them number 1: joints that follow stay"):
            crank.close_loops([well, across])
        with self.assertWarnsRegex(RuntimeWarning, r"stay open by up to .* at state 1: begin nearer"):
            crank.close_loops([well, [0.3, -0.1, 1e6]])
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            some = np.array([well, [0.3, np.nan, 0.6], [np.nan, -0.1, 0.6]])
            kept = crank.close_loops(some)
        self.assertEqual([str(s.message)[:70] for s in said], ["close_loops: 2 of 3 states, the first of them number 1, have numbers t"])
        np.testing.assert_array_equal(kept, [closed, *some[1:]])
        for text, wrong in ((r"q has shape \(2,\)", [0, 0]), (r"q\[1\] is nan", [0, np.nan, 0])):
            with self.assertRaisesRegex(ValueError, text):
                crank.close_loops(wrong)
        with self.assertRaisesRegex(ValueError, "no loop of this robot is embedded"):
            double.close_loops(double.neutral())
        self.assertEqual(pickle.loads(pickle.dumps(crank)).close_loops(well).tolist(), closed.tolist())

    def test_names_that_the_field_has(self):
        q, v = double.random(0), np.ones(double.nv)
        self.assertEqual(double.evaluate(q, v, outputs="crba").mass_matrix.tolist(), double.mass_matrix(q).tolist())
        both = double.evaluate(q, v, tau=v, outputs=["aba", "kinetic_energy", "joint_space_inertia"])
        self.assertEqual(both._fields, ("forward_dynamics", "kinetic_energy", "mass_matrix"))
        self.assertIs(double["rnea"], double.inverse_dynamics)
        self.assertIs(double.crba, double.mass_matrix)
        self.assertEqual(double.source_of("aba"), double.source_of("forward_dynamics"))
        for error, text, call in ((ValueError, "'mass_matrix' is given twice", lambda: double.evaluate(q, v, outputs=["crba", "mass_matrix"])),
                                  (KeyError, "loaded without 'inverse_mass_matrix'", lambda: double["minv"]),
                                  (AttributeError, "loaded without 'inverse_mass_matrix'", lambda: double.minv)):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()

    def test_quaternions_of_zeros_are_refused(self):
        """By name: they turn nothing, and what came of them would be numbers like any others."""
        rng = np.random.default_rng(4)
        good, zero, v = double.random(rng, 3), np.zeros(double.nq), np.zeros(double.nv)
        some = good.copy()
        some[1, 3:7] = 0
        base = r"q\[3\] to q\[6\]{}, the base's quaternion, are zero, expected a unit quaternion x y z w"
        out = np.full((double.nv, double.nv), 7.0)
        for text, call in (("mass_matrix: " + base.format(""), lambda: double.mass_matrix(zero)),
                           ("mass_matrix: " + base.format(""), lambda: double.mass_matrix(zero, out=out)),
                           ("mass_matrix: " + base.format(""), lambda: double.mass_matrix(list(zero))),
                           ("mass_matrix: " + base.format(" of state 1"), lambda: double.mass_matrix(some)),
                           ("mass_matrix: " + base.format(" of state 0"), lambda: double.mass_matrix(np.broadcast_to(zero, (3, double.nq)))),
                           (base.format(""), lambda: double.evaluate(zero, v)),
                           (base.format(""), lambda: double.both(zero, v)),
                           ("forward_dynamics_rollout: " + base.format(""), lambda: double.forward_dynamics_rollout(zero, v, steps=1, time_step=0.1)),
                           (base.format(" of state 1"), lambda: double.forward_dynamics_rollout(some, v, steps=1, time_step=0.1)),
                           (base.format(""), lambda: double.integrate(zero, v)),
                           (base.format(" of state 1").replace("q", "end", 2), lambda: double.difference(good, some))):
            with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                call()
        self.assertTrue((out == 7).all())
        self.assertTrue(np.isnan(double.both(np.full(double.nq, np.nan), v).pose_link_02).any())
        balls = dalembert.load(robots.robot("double_pendulum"), base="fixed", joints={"link_02_joint": "spherical"}, scalar="float",
                               outputs=["mass_matrix"], flags=robots.quick, batch=False)
        self.assertEqual(balls.mass_matrix(balls.neutral()).shape, (4, 4))
        with self.assertRaisesRegex(ValueError, r"q\[1\] to q\[4\], the quaternion of joint 'link_02_joint', are zero"):
            balls.mass_matrix(np.zeros(5, np.float32))


    def test_functions_called_like_something_of_every_robot(self):
        """They are robot["name"] alone, and the warning says so; the robot's own stays what it is."""
        names = ["info", "dtype", "outputs", "lambda", "None"]
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            r = dalembert.load(robots.robot("double_pendulum"), base="fixed", flags=robots.quick, batch=False, outputs=["bias"],
                               functions={name: ["bias", "gravity"] for name in names})
        text = "\n".join(str(w.message) for w in said)
        q, v = r.neutral(), np.ones(r.nv)
        for name in names:
            self.assertIn(f"the function '{name}' is robot['{name}'] alone", text)
            self.assertEqual(r[name](q, v).bias.tolist(), r.bias(q, v).tolist())
        self.assertEqual((r.dtype, set(r.outputs)), (np.float64, {"bias", *names}))

    def test_numbers_of_things_are_whole_and_there_are_some(self):
        for text, call in (("random: n is -1, expected", lambda: double.random(0, -1)),
                           ("random: n is 1.5, expected", lambda: double.random(0, 1.5)),
                           ("threads: 0 threads are too few, expected 1 to 1024", lambda: dalembert.threads(0)),
                           ("threads: 1000000 threads are too many", lambda: dalembert.threads(10**6)),
                           (f"{10**19} steps are more", lambda: double.forward_dynamics_rollout(
                               double.neutral(), np.zeros(double.nv), steps=10**19, time_step=0.01)),
                           ("'bias' is given twice", lambda: single.evaluate(single.neutral(), np.zeros(single.nv),
                                                                             outputs=["bias", "bias"]))):
            with self.subTest(text), self.assertRaisesRegex(ValueError, text):
                call()

    def test_warnings_of_one_kind_are_one(self):
        with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings(record=True) as said:
            warnings.simplefilter("always")
            urdf = pathlib.Path(folder) / "damped.urdf"
            urdf.write_text(robots.robot("double_pendulum").read_text().replace("<axis", '<axis K="7000"'))
            robot = dalembert.load(urdf, base="fixed", outputs=["center_of_mass"], flags=robots.quick, batch=False)
        texts = [str(w.message) for w in said if w.category is dalembert.InputWarning]
        self.assertEqual(len(texts), 1, texts)
        self.assertRegex(texts[0], r"'K' of <axis> .*\(the first of 2 such warnings; the robot's notices are all\)")
        self.assertEqual(len(robot.notices), 2)

    def test_states_that_are_not_finite_are_said_to_be(self):
        Q, V = double.random(np.random.default_rng(1), 3), np.zeros((3, double.nv))
        Q[1, 8] = np.nan
        with self.assertWarnsRegex(dalembert.SingularWarning, "1 of 3 states, the first of them number 1, whose q is not finite"):
            double.forward_dynamics(Q, V, V)

    def test_what_the_robot_says_of_itself(self):
        self.assertEqual((double.nq, double.nv, len(double.joint_names)), (9, 8, 2))
        self.assertEqual(double.neutral().tolist(), [0, 0, 0, 0, 0, 0, 1, 0, 0])
        self.assertIn("link_02", double.frame_names)
        self.assertTrue((double.lower_limits <= double.upper_limits).all())
        self.assertTrue((double.source / "dynamics.hpp").is_file())
        self.assertEqual(str(inspect.signature(double.mass_matrix))[:10], "(q, v=None")
        self.assertIn("kg", double.mass_matrix.__doc__)
        self.assertIn("mass_matrix", dir(double))
        self.assertIn("gravity_vector", dir(double))
        self.assertEqual(double.info and dalembert.info(robots.robot("double_pendulum"), base="fixed")["nq"], 2)
        mahru = dalembert.load(robots.mahru, base="floating", outputs=["mass_matrix", "bias"])  # numbers_test's
        self.assertTrue(np.isfinite(mahru.lower_limits).all() and (mahru.effort_limits > 0).all())
        q = mahru.random(0, 100)[:, 7:]
        self.assertTrue((q >= mahru.lower_limits).all() and (q <= mahru.upper_limits).all())


class Loading(unittest.TestCase):
    def test_what_is_wrong_is_refused_by_name(self):
        urdf = robots.robot("double_pendulum")
        for error, text, call in (
                (dalembert.InputError, "there is no such file", lambda: dalembert.load("no_such.urdf")),
                (dalembert.InputError, "there is no such file", lambda: dalembert.load(b"no_such.urdf")),
                (dalembert.InputError, "this is a directory", lambda: dalembert.load(str(robots.project))),
                (ValueError, "keyword locked: .*there is no joint 'wrist'", lambda: dalembert.load(urdf, locked={"wrist": 0.1})),
                (TypeError, "no keyword 'bse'; did you mean 'base'", lambda: dalembert.load(urdf, bse="fixed")),
                (KeyError, "there is no quantity 'mass_matrx'; did you mean 'mass_matrix'", lambda: dalembert.load(urdf, outputs=["mass_matrx"])),
                (ValueError, "keyword gravity", lambda: dalembert.load(urdf, gravity=[1, 2])),
                (ValueError, "cannot be run", lambda: dalembert.load(urdf, base="fixed", compiler="no-such-compiler")),
                (ValueError, "does not compile", lambda: dalembert.load(urdf, base="fixed", flags="-std=c++17 -no-such-flag")),
        ):
            with self.subTest(text), self.assertRaisesRegex(error, text):
                call()

    def test_of_what_was_given_then(self):
        """Whatever becomes of the caller's objects, files and working directory."""
        text = pathlib.Path(robots.robot("double_pendulum")).read_text().replace("link_01_joint", "NaN_joint").replace("link_02_joint", "b")
        here = os.getcwd()
        with tempfile.TemporaryDirectory() as folder:
            try:
                for name in ("there", "elsewhere"):
                    os.mkdir(os.path.join(folder, name))
                os.chdir(os.path.join(folder, "there"))
                pathlib.Path("arm.urdf").write_text(text)
                pathlib.Path("scene.yaml").write_text("base: fixed\nlocked: [b]\n")
                outputs = ["bias"]
                arm = dalembert.load("arm.urdf", scene="scene.yaml", outputs=outputs, friction={"NaN_joint": 2.0}, flags=robots.quick)
                outputs.append("mass_matrix")
                os.chdir(os.path.join(folder, "elsewhere"))
                self.assertEqual((arm.nv, arm.info()["nv"]), (1, 1))
                self.assertNotIn("mass_matrix", arm.info()["quantities"])
                # Its joint has one velocity, of which friction reads the sign alone.
                self.assertTrue(np.isnan(arm.bias([0.0], [np.nan])).all())
                self.assertTrue(np.isnan(arm.bias(np.zeros((9, 1)), np.full((9, 1), np.nan))).all())
                kept = pickle.dumps(arm)
                pathlib.Path("../there/arm.urdf").write_text(text.replace('mass value="', 'mass value="2'))
                again = pickle.loads(kept)
                self.assertEqual(again.bias([0.3], [1.0]), arm.bias([0.3], [1.0]))
                kept = pickle.dumps(again)
                for file in arm._folder.iterdir():  # as `dalembert cache --clear` does, of others nothing
                    if file.is_file():
                        file.unlink()
                with self.assertRaisesRegex(ValueError, "arm.urdf is not what it was when the robot that is pickled was loaded"):
                    pickle.loads(kept)
            finally:
                os.chdir(here)

    def test_what_is_passed_over_is_warned_about(self):
        with self.assertWarnsRegex(dalembert.InputWarning, "unknown"):
            warnings.simplefilter("always", dalembert.InputWarning)
            try:
                dalembert.load(robots.project / "tests/error/unknown_attribute.urdf", base="fixed", outputs=["mass_matrix"],
                               flags=robots.quick)
            finally:
                warnings.simplefilter("ignore", dalembert.InputWarning)


class MadeUp(unittest.TestCase):
    def test_right_or_refused(self):
        made_up.right_or_refused([double, single, arm], CASES)


if __name__ == "__main__":
    unittest.main()
