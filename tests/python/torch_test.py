"""dalembert.torch: gradients against differences, where PyTorch is installed."""

import sys
import unittest
import warnings

try:
    import torch
except ImportError:
    print("PyTorch is not installed")
    sys.exit(77)

import numpy as np

import robots
import dalembert
from dalembert.torch import forward_dynamics, inverse_dynamics, regressor_forces

warnings.simplefilter("ignore", dalembert.InputWarning)

OUTPUTS = ["mass_matrix", "inverse_mass_matrix", "inverse_dynamics", "inverse_dynamics_dq", "inverse_dynamics_dv", "forward_dynamics",
           "forward_dynamics_dq", "forward_dynamics_dv", "regressor", "bias"]


class Gradients(unittest.TestCase):
    def check(self, base):
        robot = dalembert.load(robots.robot("double_pendulum"), base=base, outputs=OUTPUTS, flags=robots.quick, batch=False)
        rng = np.random.default_rng(2)
        for n in (None, 3):
            rows = () if n is None else (n,)
            tensor = lambda x: torch.tensor(x, requires_grad=True)
            q, v, x = tensor(robot.random(rng, n)), tensor(rng.normal(size=(*rows, robot.nv))), tensor(rng.normal(size=(*rows, robot.nv)))

            def unit(q):
                if base == "fixed":
                    return q
                return torch.cat([q[..., :3], q[..., 3:7] / q[..., 3:7].norm(dim=-1, keepdim=True), q[..., 7:]], -1)

            for function in (inverse_dynamics, forward_dynamics):
                self.assertTrue(torch.autograd.gradcheck(lambda q, v, x: function(robot, unit(q), v, x), (q, v, x), atol=1e-5, rtol=1e-4))
            phi = torch.randn(10 * len(robot.body_names), dtype=torch.float64, requires_grad=True)
            self.assertTrue(torch.autograd.gradcheck(lambda phi: regressor_forces(robot, q, v, x, phi), (phi,)))
            self.assertTrue(np.array_equal(inverse_dynamics(robot, q, v, x).detach().numpy(),
                                           robot.inverse_dynamics(q.detach().numpy(), v.detach().numpy(), x.detach().numpy())))

    def test_on_a_fixed_base(self):
        self.check("fixed")

    def test_on_a_floating_base(self):
        self.check("floating")

    def test_what_is_missing_is_said(self):
        robot = dalembert.load(robots.robot("pendulum"), base="fixed", outputs=["mass_matrix"], flags=robots.quick, batch=False)
        one = torch.zeros(1, dtype=torch.float64)
        self.assertRaisesRegex(KeyError, "forward_dynamics_dq.* is missing", forward_dynamics, robot, one, one, one)

    def test_tensors_share_their_memory(self):
        robot = dalembert.load(robots.robot("pendulum"), base="fixed", outputs=["mass_matrix"], flags=robots.quick, batch=False)
        q = torch.zeros(4, 1, dtype=torch.float64)
        out = torch.empty(4, 1, 1, dtype=torch.float64)
        robot.mass_matrix(q, out=out.numpy())
        self.assertTrue(np.array_equal(out.numpy(), robot.mass_matrix(q.numpy())))


if __name__ == "__main__":
    unittest.main()
