"""A robot's dynamics, compiled: a URDF goes in, functions on numpy arrays come out.

    import dalembert
    robot = dalembert.load("arm.urdf", base="fixed", outputs=["mass_matrix", "bias", "forward_dynamics"])
    M = robot.mass_matrix(q)                  # (nv, nv)
    dv = robot.forward_dynamics(Q, V, TAU)    # n states, row by row: (n, nv)

Units are SI. Twists and wrenches have their linear part first. On a fixed base q and v are the joints' positions and rates; on a
floating base q = [position in the world (3), quaternion x y z w (4), joints], v = [linear (3) and angular velocity (3) in the base's
axes, joint rates]. docs/python.md is a first page, docs/scene.md describes the keywords of load().
"""

from ._build import InputError, SelfTestError, check, clear_cache, info, link_quantities, quantities, report, scene_keys
from ._core import ConstraintStatus, SingularError, SingularWarning, StoppedWarning, threads
from ._place import VERSION as __version__
from ._robot import Contact, InputWarning, LinkageStatus, Loop, Payload, Robot, load

__all__ = [
    "ConstraintStatus", "Contact", "InputError", "InputWarning", "LinkageStatus", "Loop", "Payload", "Robot", "SelfTestError", "SingularError", "SingularWarning", "StoppedWarning",
    "check", "clear_cache", "info", "link_quantities", "load", "quantities", "report", "scene_keys", "threads",
]
