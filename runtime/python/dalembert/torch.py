"""A robot's dynamics as differentiable functions of PyTorch's tensors.

    from dalembert.torch import forward_dynamics
    robot = dalembert.load("arm.urdf", base="fixed",
                           outputs=["forward_dynamics", "forward_dynamics_dq", "forward_dynamics_dv", "inverse_mass_matrix"])
    dv = forward_dynamics(robot, q, v, tau)        # (nv,) or (n, nv); dv.sum().backward()

Tensors are of the robot's dtype, on the CPU, and share their memory with numpy; one state or n, row by row, all arguments alike.
Derivatives are the generated code's, exact to rounding, and are themselves not differentiable. On a floating base a gradient with respect
to q is that of the function of the normalised quaternion: it has no part along the quaternion, and optimisers leave its length to you.
"""

import numpy
import torch
from torch.autograd.function import once_differentiable

__all__ = ["forward_dynamics", "inverse_dynamics", "regressor_forces"]


def _needs(robot, function, outputs):
    missing = [name for name in outputs if name not in robot.outputs]
    if missing:
        raise KeyError(f"{function} needs a robot loaded with outputs {', '.join(outputs)}; {', '.join(missing)} is missing")


def _arrays(robot, *tensors):
    dtype = torch.float32 if robot.dtype == numpy.float32 else torch.float64
    for tensor in tensors:
        if tensor.dtype != dtype or tensor.device.type != "cpu":
            raise ValueError(f"a tensor of {tensor.dtype} on {tensor.device} was given, expected {dtype} on the CPU")
    if len({tensor.dim() for tensor in tensors}) != 1:
        raise ValueError("one state and many do not go together: expand the tensors to as many rows")
    return [tensor.detach().numpy() for tensor in tensors]


def _times(gradient, matrix):
    """Row vectors times matrices, of one state or n."""
    return numpy.einsum("...i,...ij->...j", gradient, matrix)


def _to_positions(robot, q, gradient):
    """A gradient along v's coordinates as one by q's: a pose's linear part is turned out of its own axes, the angular one made the
    quaternion's."""
    parts, at = [], 0  # at: in v
    poses = [(0, 0, 1)] * robot.floating_base + [tuple(row) for row in robot._quaternions]
    for first, start, slides in poses:
        parts.append(gradient[..., at:start])
        x, y, z, w = (q[..., first + 3 * slides + i] for i in range(4))
        if slides:
            rotation = numpy.stack([
                numpy.stack([1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)], -1),
                numpy.stack([2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)], -1),
                numpy.stack([2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)], -1)], -2)
            parts.append(numpy.einsum("...ij,...j->...i", rotation, gradient[..., start:start + 3]))
        turn = start + 3 * slides
        a, b, c = (gradient[..., turn + i] for i in range(3))
        # The quaternion's rate is q (w/2, 0): a turn by a small vector moves it by half of these columns, which are orthonormal.
        parts.append(2 * numpy.stack([w * a - z * b + y * c, z * a + w * b - x * c, -y * a + x * b + w * c,
                                      -x * a - y * b - z * c], -1))
        at = turn + 3
    return numpy.concatenate(parts + [gradient[..., at:]], -1)


class _InverseDynamics(torch.autograd.Function):
    @staticmethod
    def forward(ctx, robot, q, v, a):
        ctx.robot = robot
        ctx.save_for_backward(q, v, a)
        return torch.from_numpy(robot.inverse_dynamics(*_arrays(robot, q, v, a)))

    @staticmethod
    @once_differentiable
    def backward(ctx, gradient):
        robot, (q, v, a) = ctx.robot, _arrays(ctx.robot, *ctx.saved_tensors)
        gradient, needed = gradient.numpy(), ctx.needs_input_grad
        by_q = _to_positions(robot, q, _times(gradient, robot.inverse_dynamics_dq(q, v, a))) if needed[1] else None
        by_v = _times(gradient, robot.inverse_dynamics_dv(q, v, a)) if needed[2] else None
        by_a = _times(gradient, robot.mass_matrix(q)) if needed[3] else None
        return (None, *(None if x is None else torch.from_numpy(x) for x in (by_q, by_v, by_a)))


class _ForwardDynamics(torch.autograd.Function):
    @staticmethod
    def forward(ctx, robot, q, v, tau):
        ctx.robot = robot
        ctx.save_for_backward(q, v, tau)
        return torch.from_numpy(robot.forward_dynamics(*_arrays(robot, q, v, tau)))

    @staticmethod
    @once_differentiable
    def backward(ctx, gradient):
        robot, (q, v, tau) = ctx.robot, _arrays(ctx.robot, *ctx.saved_tensors)
        gradient, needed = gradient.numpy(), ctx.needs_input_grad
        by_q = _to_positions(robot, q, _times(gradient, robot.forward_dynamics_dq(q, v, tau))) if needed[1] else None
        by_v = _times(gradient, robot.forward_dynamics_dv(q, v, tau)) if needed[2] else None
        by_tau = _times(gradient, robot.inverse_mass_matrix(q)) if needed[3] else None
        return (None, *(None if x is None else torch.from_numpy(x) for x in (by_q, by_v, by_tau)))


def inverse_dynamics(robot, q, v, a):
    """τ = M a + C v + g, differentiable by q, v and a. Outputs needed: inverse_dynamics, inverse_dynamics_dq, inverse_dynamics_dv,
    mass_matrix."""
    _needs(robot, "inverse_dynamics", ("inverse_dynamics", "inverse_dynamics_dq", "inverse_dynamics_dv", "mass_matrix"))
    return _InverseDynamics.apply(robot, q, v, a)


def forward_dynamics(robot, q, v, tau):
    """v̇ with M v̇ + C v + g = τ, differentiable by q, v and tau. Outputs needed: forward_dynamics, forward_dynamics_dq,
    forward_dynamics_dv, inverse_mass_matrix."""
    _needs(robot, "forward_dynamics", ("forward_dynamics", "forward_dynamics_dq", "forward_dynamics_dv", "inverse_mass_matrix"))
    return _ForwardDynamics.apply(robot, q, v, tau)


def regressor_forces(robot, q, v, a, parameters):
    """τ = Y(q, v, a) φ, differentiable by the inertial parameters φ: ten per body (docs/scene.md), one vector for all states. Output
    needed: regressor."""
    _needs(robot, "regressor_forces", ("regressor",))
    regressor = torch.from_numpy(robot.regressor(*_arrays(robot, q, v, a)))
    return regressor @ parameters
