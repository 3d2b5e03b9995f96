#!/usr/bin/env python3
"""Writes mechanisms of this folder, each a URDF and its scene: forty four-bars, the stiff flyball governor, a Stewart platform, a
delta robot and legs with four-bars.

    python3 tests/numeric/generated/mechanisms/make_mechanisms.py        the output depends on nothing but this file and make_robots.py

With all joints at zero every loop but the governor's is closed to rounding.
"""
import math
import pathlib
import sys

FOLDER = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(FOLDER.parents[2] / "robots"))
from make_robots import Inertial  # noqa: E402

ENERGIES = "kinetic_energy, potential_energy, constrained_forward_dynamics, constraint_forces"


def numbers(vector):
    return " ".join(repr(float(x) + 0.0) for x in vector)


def listed(vector):
    return "[" + ", ".join(repr(float(x) + 0.0) for x in vector) + "]"


def towards(direction):
    """Roll, pitch and yaw that turn z into the direction."""
    x, y, z = direction
    return [0, math.atan2(math.hypot(x, y), z), math.atan2(y, x)]


def rod(mass, length, width, middle):
    """A square rod along z, its middle at z = `middle`."""
    return Inertial.box(mass, [0, 0, middle], (width, width, length))


class Mechanism:
    def __init__(self, name, about, gravity="[0, 0, -9.81]", base="fixed", root=None, outputs=""):
        self.outputs = outputs
        self.name, self.about, self.gravity, self.base = name, about, gravity, base
        self.lines, self.loops, self.joints, self.stiffness = [], [], [], []
        self.link("world" if root is None else "base", root)

    def link(self, name, inertial):
        self.lines.append(f'  <link name="{name}">{inertial.xml()}</link>' if inertial else f'  <link name="{name}"/>')

    def add(self, name, parent, kind, inertial, xyz=(0, 0, 0), rpy=(0, 0, 0), axis=None, universal=None, k=None):
        """A link on `parent`, moved by the joint of its name; k: of a spring at its place at zero."""
        self.link(name, inertial)
        moving = f'<axis xyz="{numbers(axis)}"/>' if axis else ""
        if kind == "prismatic":
            moving += '<limit lower="-3" upper="3" effort="1e4" velocity="1e2"/>'
        self.lines.append(f'  <joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
                          f'<origin xyz="{numbers(xyz)}" rpy="{numbers(rpy)}"/>{moving}</joint>')
        if universal:
            self.joints.append(f"  {name}_joint: {{universal: {universal}}}")
        if k:
            self.stiffness.append(f"  {name}_joint: {k}")
        return name

    def close(self, name, links, at, kind, independent=()):
        more = f", independent: [{', '.join(independent)}]" if independent else ""
        self.loops.append(f"  {name}: {{links: [{links[0]}, {links[1]}], at: [{listed(at[0])}, {listed(at[1])}], type: {kind}{more}}}")

    def write(self):
        body = "\n".join(self.lines)
        (FOLDER / f"{self.name}.urdf").write_text(
            f'<?xml version="1.0"?>\n<!-- {self.about} Written by make_mechanisms.py. -->\n<robot name="{self.name}">\n{body}\n</robot>\n')
        parts = [f"# {self.about} Written by make_mechanisms.py.", f"base: {self.base}", f"gravity: {self.gravity}",
                 f"outputs: [{self.outputs}]" if self.outputs else f"outputs: [{ENERGIES if self.gravity != 'none' or self.stiffness else ENERGIES.replace('potential_energy, ', '')}]"]
        for key in ("joints", "stiffness", "loops"):
            if getattr(self, key):
                parts += [f"{key}:"] + getattr(self, key)
        (FOLDER / f"{self.name}.yaml").write_text("\n".join(parts) + "\n")


def four_bars():
    robot = Mechanism("four_bars_40", "Forty four-bars (IFToMM benchmark A02): links of 1 m and 1 kg, slender, 41 upright and 40 across.",
                      gravity="[0, -9.81, 0]")
    slender = 1 / 12
    for i in range(41):
        robot.add(f"upright_{i:02d}", "world", "continuous", Inertial(1, [0, 0.5, 0], [0, 0, 0], [slender, 0, 0, 1e-4, 0, slender]),
                  (i, 0, 0), axis=(0, 0, 1))
        if i < 40:
            robot.add(f"across_{i:02d}", f"upright_{i:02d}", "continuous",
                      Inertial(1, [0.5, 0, 0], [0, 0, 0], [1e-4, 0, 0, slender, 0, slender]), (0, 1, 0), axis=(0, 0, 1))
    for i in range(40):
        robot.close(f"bar_{i:02d}", (f"across_{i:02d}", f"upright_{i + 1:02d}"), ((1, 0, 0), (0, 1, 0)), "pin")
    robot.write()


def governor():
    robot = Mechanism("governor", "The stiff flyball governor (IFToMM benchmark A05): rods and couplers of a governor that turns.")
    robot.add("shaft", "world", "continuous", rod(0.3, 1, 0.01, 0.5), axis=(0, 0, 1))
    robot.add("slider", "shaft", "prismatic", Inertial.box(3, [0, 0, 0], (0.1, 0.1, 0.1)), axis=(0, 0, 1))
    # 0.3 kg along x, 5 kg at its end.
    mass, com = 5.3, (0.3 * 0.5 + 5) / 5.3
    across = 0.3 * (1 + 1e-4) / 12 + 0.3 * (com - 0.5)**2 + 5 * (1 - com)**2
    ball = Inertial(mass, [com, 0, 0], [0, 0, 0], [0.3 * 2e-4 / 12, 0, 0, across, 0, across])
    for name, yaw, x in (("left", 0, 0.05), ("right", math.pi, -0.05)):
        robot.add(f"rod_{name}", "shaft", "continuous", ball, (x, 0, 1), (0, 0, yaw), axis=(0, 1, 0))
        robot.close(name, ("slider", f"rod_{name}"), ((x, 0, 0), (0.5, 0, 0)), "distance, length: 0.5")
    robot.write()


def stewart():
    robot = Mechanism("stewart", "A Stewart platform: six legs, each a universal joint and a slide, balls at the platform.")
    height = 0.7
    robot.add("platform", "world", "floating", Inertial.box(20, [0.03, -0.02, 0.04], (0.6, 0.5, 0.08)), (0, 0, height))
    for i in range(6):
        side, pair = (1 if i % 2 else -1), 2 * math.pi / 3 * (i // 2)
        below, above = pair + side * math.radians(12), pair + side * math.radians(45)
        foot = [0.6 * math.cos(below), 0.6 * math.sin(below), 0]
        ball = [0.35 * math.cos(above), 0.35 * math.sin(above), -0.05]
        leg = [ball[0] - foot[0], ball[1] - foot[1], ball[2] + height - foot[2]]
        length = math.sqrt(sum(x * x for x in leg))
        robot.add(f"cylinder_{i + 1}", "world", "continuous", rod(2, 0.4, 0.06, 0.2), foot, towards(leg), (1, 0, 0),
                  universal="[0, 1, 0]")
        robot.add(f"piston_{i + 1}", f"cylinder_{i + 1}", "prismatic", rod(0.8, 0.4, 0.03, -0.2), (0, 0, length), axis=(0, 0, 1), k=5000)
        robot.close(f"ball_{i + 1}", ("platform", f"piston_{i + 1}"), (ball, (0, 0, 0)), "point")
    robot.write()


def delta():
    robot = Mechanism("delta", "A delta robot: three arms, each with two rods, balls at the platform.")
    reach, rod_length, narrow = 0.4, 0.5, 0.05
    down = -math.sqrt(rod_length**2 - (reach - narrow)**2)
    robot.add("platform", "world", "floating", Inertial.box(0.4, [0, 0, -0.01], (0.1, 0.12, 0.02)), (0, 0, down))
    for i in range(3):
        yaw = 2 * math.pi / 3 * i
        c, s = math.cos(yaw), math.sin(yaw)
        arm = robot.add(f"arm_{i + 1}", "world", "continuous", Inertial.box(0.6, [0.09, 0, 0], (0.2, 0.03, 0.04)), (0.2 * c, 0.2 * s, 0),
                        (0, 0, yaw), (0, 1, 0), k=20)
        for name, y in (("a", -0.04), ("b", 0.04)):
            forearm = robot.add(f"rod_{i + 1}{name}", arm, "continuous", rod(0.06, rod_length, 0.01, rod_length / 2), (0.2, y, 0),
                                towards((narrow - reach, 0, down)), (1, 0, 0), universal="[0, 1, 0]")
            robot.close(f"ball_{i + 1}{name}", ("platform", forearm), ((narrow * c - y * s, narrow * s + y * c, 0), (0, 0, rod_length)), "point")
    robot.write()


def legs():
    """Each leg: three hips, a knee, and a tarsus that a rod to the thigh turns with it; a crank on the tarsus turns the foot by
    a four-bar."""
    robot = Mechanism("legs", "A biped in flight whose legs have four-bars, as Cassie's and Digit's do.", gravity="none", base="floating",
                      root=Inertial.box(12, [0.02, 0.01, 0.1], (0.25, 0.3, 0.35)))
    for side, sign in (("left", 1), ("right", -1)):
        def add(name, parent, xyz, axis, inertial, k=None):
            return robot.add(f"{side}_{name}", parent, "continuous", inertial, xyz, axis=axis, k=k)

        roll = add("hip_roll", "base", (0.02, 0.13 * sign, 0), (1, 0, 0), Inertial.box(1.8, [0, 0, -0.03], (0.1, 0.1, 0.12)), 60)
        yaw = add("hip_yaw", roll, (0, 0, -0.09), (0, 0, 1), Inertial.box(1.2, [0, 0, -0.02], (0.09, 0.1, 0.1)), 60)
        thigh = add("thigh", yaw, (0, 0, 0), (0, 1, 0), Inertial.box(5, [0.02, 0, -0.12], (0.12, 0.1, 0.35)), 80)
        shin = add("shin", thigh, (0.06, 0, -0.35), (0, 1, 0), Inertial.box(0.8, [-0.01, 0, -0.17], (0.05, 0.05, 0.4)), 80)
        tarsus = add("tarsus", shin, (-0.05, 0, -0.38), (0, 1, 0), Inertial.box(0.8, [0.03, 0, -0.15], (0.06, 0.06, 0.4)))
        crank = add("crank", tarsus, (0.02, 0, -0.06), (0, 1, 0), Inertial.box(0.14, [0.02, 0, 0], (0.05, 0.02, 0.02)), 30)
        plantar = add("plantar", crank, (0.055, 0, 0), (0, 1, 0), Inertial.box(0.12, [0, 0, -0.15], (0.01, 0.01, 0.3)))
        foot = add("foot", tarsus, (0.025, 0, -0.36), (0, 1, 0), Inertial.box(0.25, [0.01, 0, -0.04], (0.18, 0.05, 0.03)))
        robot.close(f"{side}_achilles", (thigh, tarsus), ((-0.02, 0, 0), (-0.09, 0, 0.02)), "distance")
        # Across the plane of the linkage is y: z of the pin.
        across = (-math.pi / 2, 0, 0)
        robot.close(f"{side}_toes", (plantar, foot), ((0, 0, -0.30) + across, (0.05, 0, 0) + across), "pin")
    robot.write()


def ankle():
    """Two motors in the shin turn cranks, whose rods turn the foot about pitch and roll together: loops are embedded."""
    robot = Mechanism("ankle", "A parallel ankle: two cranks, and rods to the foot, which are embedded.",
                      outputs="mass_matrix, coriolis_matrix, bias, kinetic_energy, potential_energy, inverse_dynamics, forward_dynamics")
    shin = robot.add("shin", "world", "revolute", Inertial.box(2.5, [0, 0, -0.15], (0.08, 0.08, 0.3)), (0, 0, 0.6), axis=(0, 1, 0))
    cross = robot.add("pitch", shin, "revolute", Inertial.box(0.1, [0, 0, 0], (0.03, 0.03, 0.03)), (0, 0, -0.35), axis=(0, 1, 0))
    foot = robot.add("foot", cross, "revolute", Inertial.box(0.9, [0.03, 0, -0.05], (0.22, 0.09, 0.04)), axis=(1, 0, 0))
    for side, y, z in (("left", 0.045, -0.08), ("right", -0.045, -0.14)):
        crank = robot.add(f"{side}_crank", shin, "revolute", Inertial.box(0.15, [-0.03, 0, 0], (0.07, 0.02, 0.02)), (0, y, z), axis=(0, 1, 0))
        length = 0.35 + z  # down to the foot, whose ball is as far behind the ankle as the crank is long
        tie = robot.add(f"{side}_rod", crank, "revolute", rod(0.12, length, 0.01, -length / 2), (-0.06, 0, 0), axis=(0, 1, 0),
                        universal="[1, 0, 0]")
        robot.close(f"{side}_ball", (tie, foot), ((0, 0, -length, 0, 0, 0), (-0.06, y, 0.0, 0, 0, 0)), "point", [f"{side}_crank_joint"])
    robot.write()


if __name__ == "__main__":
    for make in (four_bars, governor, stewart, delta, legs, ankle):
        make()
