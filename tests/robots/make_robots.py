#!/usr/bin/env python3
"""Writes the test robots of this folder: each chosen for its topology, with generic numbers so that no error hides.

    python3 tests/robots/make_robots.py        rewrites every URDF here; the output depends on nothing but this file

Inertias are those of boxes with three different sides, turned to generic directions (off-diagonal elements), with the
inertial frame turned once more (rpy), so that every one is physically valid. Numbers come from a linear congruential
generator of our own: Python's may change between versions. Joint names are chosen so that alphabetical order, which is
urdfdom's, is the order in which they are added here.
"""
import math
import pathlib

FOLDER = pathlib.Path(__file__).resolve().parent


class Numbers:
    """Uniform numbers in [low, high], seeded by a name."""

    def __init__(self, name):
        self.state = sum((i + 1) * ord(c) for i, c in enumerate(name)) + 12345

    def __call__(self, low, high, digits=4):
        self.state = (6364136223846793005 * self.state + 1442695040888963407) % 2**64
        return round(low + (high - low) * (self.state >> 11) / 2**53, digits)

    def vector(self, size):
        return [self(-size, size) for _ in range(3)]


def rotation(rpy):
    (sr, sp, sy), (cr, cp, cy) = map(math.sin, rpy), map(math.cos, rpy)
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr]]


def text(vector):
    return " ".join(format(x + 0.0, ".12g") for x in vector)


class Inertial:
    """Mass, centre of mass, orientation of the inertial frame, and the inertia in it: xx xy xz yy yz zz."""

    def __init__(self, mass, com, rpy, elements):
        self.mass, self.com, self.rpy, self.elements = mass, com, rpy, elements

    @staticmethod
    def box(mass, com, sides, turned=(0, 0, 0), rpy=(0, 0, 0)):
        a, b, c = (s * s for s in sides)
        principal = [mass / 12 * (b + c), mass / 12 * (a + c), mass / 12 * (a + b)]
        R = rotation(turned)
        full = [[sum(R[i][k] * principal[k] * R[j][k] for k in range(3)) for j in range(3)] for i in range(3)]
        return Inertial(mass, com, rpy, [float(f"{full[i][j]:.6g}") for i in range(3) for j in range(i, 3)])

    def mirrored(self):
        """Reflected in the plane y = 0."""
        xx, xy, xz, yy, yz, zz = self.elements
        return Inertial(self.mass, mirrored_vector(self.com), mirrored_axis(self.rpy), [xx, -xy, xz, yy, -yz, zz])

    def xml(self):
        names = ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        elements = " ".join(f'{n}="{format(e + 0.0, ".12g")}"' for n, e in zip(names, self.elements))
        return (f'<inertial><origin xyz="{text(self.com)}" rpy="{text(self.rpy)}"/><mass value="{self.mass:.12g}"/>'
                f"<inertia {elements}/></inertial>")


def mirrored_vector(v):
    return [v[0], -v[1], v[2]]


def mirrored_axis(a):
    return [-a[0], a[1], -a[2]]


class Robot:
    def __init__(self, name, about, base="generic"):
        self.name, self.about, self.numbers, self.lines = name, about, Numbers(name), []
        self.link("base", self.inertial(6) if base == "generic" else base)

    def inertial(self, scale=1.0):
        n = self.numbers
        sides = [n(0.1, 0.2), n(0.2, 0.3), n(0.3, 0.4)]
        return Inertial.box(round(scale * n(0.5, 2), 4), n.vector(0.2), sides, n.vector(3), n.vector(1.5))

    def link(self, name, inertial):
        self.lines.append(f'  <link name="{name}">{inertial.xml()}</link>' if inertial else f'  <link name="{name}"/>')

    def add(self, name, parent, kind="revolute", inertial="generic", xyz=None, rpy=None, axis=None):
        """A link `name` on `parent`, moved by the joint `name`_joint; what is not given is generic."""
        n = self.numbers
        xyz = n.vector(0.4) if xyz is None else xyz
        rpy = n.vector(2) if rpy is None else rpy
        axis = n.vector(1) if axis is None else axis
        self.link(name, self.inertial() if inertial == "generic" else inertial)
        moving = "" if kind == "fixed" else f'<axis xyz="{text(axis)}"/>'
        if kind in ("revolute", "prismatic"):
            moving += '<limit lower="-3" upper="3" effort="100" velocity="10"/>'
        self.lines.append(f'  <joint name="{name}_joint" type="{kind}"><parent link="{parent}"/><child link="{name}"/>'
                          f'<origin xyz="{text(xyz)}" rpy="{text(rpy)}"/>{moving}</joint>')
        return name

    def chain(self, prefix, parent, length, **how):
        for i in range(length):
            parent = self.add(f"{prefix}_{i + 1:02d}", parent, **how)
        return parent

    def write(self, folder=FOLDER):
        body = "\n".join(self.lines)
        path = folder / f"{self.name}.urdf"
        path.write_text(f'<?xml version="1.0"?>\n<!-- {self.about} Written by make_robots.py. -->\n'
                        f'<robot name="{self.name}">\n{body}\n</robot>\n')


class Limb:
    """A chain with fixed numbers, to be attached several times: the same limb, or its mirror image."""

    def __init__(self, name, segments):
        helper = Robot(name, "")
        n = helper.numbers
        self.segments = [(s, helper.inertial(), n.vector(0.3), n.vector(1), n.vector(1)) for s in segments]

    def attach(self, robot, prefix, parent, xyz, rpy=(0, 0, 0), mirror=False):
        for i, (segment, inertial, offset, turn, axis) in enumerate(self.segments):
            place, orientation = (xyz, list(rpy)) if i == 0 else (offset, turn)
            if mirror:
                inertial, place = inertial.mirrored(), mirrored_vector(place)
                orientation, axis = mirrored_axis(orientation), mirrored_axis(axis)
            parent = robot.add(f"{prefix}_{segment}", parent, "revolute", inertial, place, orientation, axis)
        return parent


def chains():
    for name, length, about in (("pendulum", 1, "One joint."), ("double_pendulum", 2, "Two joints."),
                                ("chain_7", 7, "A serial arm with generic axes."), ("chain_50", 50, "A long chain.")):
        robot = Robot(name, about)
        robot.chain("link", "base", length)
        robot.write()

    planar = Robot("planar_chain_10", "Parallel axes, centres of mass on the links' lines: many structural zeros.",
                   Inertial.box(5, [0, 0, 0], (0.3, 0.2, 0.1)))
    skew = Robot("skew_chain_10", "planar_chain_10 with generic axes, offsets and inertias.")
    for i in range(10):
        length = round(0.5 - 0.03 * i, 4)
        box = Inertial.box(round(2 - 0.15 * i, 4), [length / 2, 0, 0], (length, 0.05, 0.08))
        parent = f"link_{i:02d}" if i else "base"
        planar.add(f"link_{i + 1:02d}", parent, "revolute", box, [0 if i == 0 else round(length + 0.03, 4), 0, 0], [0, 0, 0], [0, 1, 0])
    skew.chain("link", "base", 10)
    planar.write()
    skew.write()

    robot = Robot("skew_axes", "Axes that are not of unit length, nor along any coordinate.")
    for i, axis in enumerate(([1, 2, 3], [-0.3, 0.1, 0.02], [5, -7, 1])):
        robot.add(f"link_{i + 1}", f"link_{i}" if i else "base", axis=axis)
    robot.write()


def branches():
    for name, count in (("two_branches_at_base", 2), ("three_branches_at_base", 3)):
        robot = Robot(name, f"{count} limbs of unlike numbers on the base.")
        for branch in "abc"[:count]:
            robot.chain(branch, "base", 2)
        robot.write()

    robot = Robot("branch_below_base", "A trunk of two, then two limbs: a branch that is not at the base.")
    trunk = robot.chain("a", "base", 2)
    robot.chain("b", trunk, 2)
    robot.chain("c", trunk, 3)
    robot.write()

    robot = Robot("two_levels_of_branching", "A limb branches, and one of its branches branches again.")
    trunk = robot.chain("a", "base", 1)
    first = robot.chain("b", trunk, 2)
    robot.chain("c", first, 1)
    robot.chain("d", first, 2)
    robot.chain("e", trunk, 2)
    robot.chain("f", "base", 1)
    robot.write()

    robot = Robot("unequal_limbs", "Limbs of 1, 2, 3 and 5 joints, revolute and prismatic.")
    for branch, length in (("a", 1), ("b", 3), ("c", 2), ("d", 5)):
        parent = "base"
        for i in range(length):
            parent = robot.add(f"{branch}_{i + 1}", parent, "prismatic" if (length + i) % 4 == 3 else "revolute")
    robot.write()

    robot = Robot("tree_5x20", "Five branches of twenty joints on the base.")
    for branch in "abcde":
        robot.chain(branch, "base", 20)
    robot.write()


def joint_types():
    robot = Robot("prismatic_mix", "Prismatic joints first, in the middle and last.")
    for i, kind in enumerate(("prismatic", "revolute", "prismatic", "revolute", "prismatic")):
        robot.add(f"link_{i + 1}", f"link_{i}" if i else "base", kind)
    robot.write()

    robot = Robot("gantry", "Prismatic joints only, along x, y and z: M is constant, C is zero with a fixed base.")
    for i, axis in enumerate(([1, 0, 0], [0, 1, 0], [0, 0, 1])):
        robot.add(f"link_{i + 1}", f"link_{i}" if i else "base", "prismatic", rpy=[0, 0, 0], axis=axis)
    robot.write()

    robot = Robot("gantry_arms", "Two arms on carriages of one bridge: no slide's position changes M or C with a fixed base.")
    robot.add("bridge", "base", "prismatic")
    for side in "ab":
        robot.add(f"{side}_carriage", "bridge", "prismatic")
        robot.add(f"{side}_lift", f"{side}_carriage", "prismatic")
        for i in range(3):
            robot.add(f"{side}_arm_{i + 1}", f"{side}_arm_{i}" if i else f"{side}_lift", "revolute")
    robot.add("a_tool", "a_arm_3", "prismatic")
    robot.write()

    robot = Robot("continuous_joints", "A cart with wheels: continuous joints, and an arm of one on top.")
    for i, place in enumerate(([0.3, 0.2, -0.1], [0.3, -0.2, -0.1], [-0.3, 0.2, -0.1])):
        robot.add(f"wheel_{i + 1}", "base", "continuous", xyz=place)
    robot.add("x_arm", "base", "continuous")
    robot.add("y_arm", "x_arm", "revolute")
    robot.write()


def inertias():
    robot = Robot("rotated_fixed_links", "Turned fixed links in the middle and at the leaves, to be fused.")
    mount = robot.add("a_mount", "base", "fixed")
    upper = robot.add("b_upper", mount)
    adapter = robot.add("c_adapter", upper, "fixed")
    bracket = robot.add("d_bracket", adapter, "fixed")
    lower = robot.add("e_lower", bracket)
    robot.add("f_tool", lower, "fixed")
    tip = robot.add("g_sensor", lower, "fixed")
    robot.add("h_tip", tip, "fixed")
    robot.write()

    robot = Robot("offset_inertias", "Light bodies with centres of mass far from their joints.")
    parent = "base"
    for i in range(4):
        inertial = robot.inertial(0.3)
        inertial.com = robot.numbers.vector(3)
        parent = robot.add(f"link_{i + 1}", parent, "revolute", inertial)
    robot.write()

    robot = Robot("frames_without_inertia", "A root without inertia, and frames without inertia in the middle and at a leaf.", None)
    body = robot.add("a_body", "base", "fixed")
    upper = robot.add("b_upper", body)
    flange = robot.add("c_flange", upper, "fixed", None)
    lower = robot.add("d_lower", flange)
    robot.add("e_camera", lower, "fixed", None)
    robot.write()

    robot = Robot("massless_intermediate", "Universal and spherical wrists: moving links without inertia between bodies.")
    cross = robot.add("a_cross", "base", "revolute", None)
    upper = robot.add("b_upper", cross, xyz=[0, 0, 0])
    yaw = robot.add("c_yaw", upper, "revolute", None)
    pitch = robot.add("d_pitch", yaw, "revolute", None, xyz=[0, 0, 0])
    robot.add("e_tool", pitch, xyz=[0, 0, 0])
    robot.write()


def limbs():
    arm = Limb("arm", ("1_shoulder", "2_elbow", "3_wrist"))
    robot = Robot("mirror_pair", "Two arms, mirror images in the plane y = 0.")
    arm.attach(robot, "left", "base", [0.1, 0.3, 0.2], (0.2, 0.1, -0.3))
    arm.attach(robot, "right", "base", [0.1, 0.3, 0.2], (0.2, 0.1, -0.3), mirror=True)
    robot.write()

    finger = Limb("gripper_finger", ("1_proximal", "2_distal"))
    robot = Robot("grippers", "A trunk, two arms side by side and two fingers on each: four limbs below two.")
    robot.add("a_trunk", "base")
    for side in ("left", "right"):
        arm.attach(robot, f"b_arm_{side}", "a_trunk", [0.1, 0.3, 0.2], (0.2, 0.1, -0.3), mirror=side == "right")
        for i in range(2):
            finger.attach(robot, f"b_arm_{side}_4_finger_{i + 1}", f"b_arm_{side}_3_wrist", [0.05, 0.04 * i, 0.1], (0.1 * i, 0, 0.2))
    robot.write()

    leg = Limb("quadruped_leg", ("1_hip", "2_thigh", "3_shank"))
    robot = Robot("quadruped", "Four legs of three joints; right ones are mirror images of left ones.")
    for prefix, x in (("front", 0.4), ("hind", -0.4)):
        for side in ("left", "right"):
            leg.attach(robot, f"{prefix}_{side}", "base", [x, 0.2, 0], mirror=side == "right")
    robot.write()

    leg = Limb("hexapod_leg", ("1_coxa", "2_femur", "3_tibia"))
    robot = Robot("hexapod", "Six equal legs of three joints, set around the base.")
    for i in range(6):
        angle = math.pi / 3 * i
        place = [round(0.3 * math.cos(angle), 6), round(0.3 * math.sin(angle), 6), 0.02]
        leg.attach(robot, f"leg_{i + 1}", "base", place, (0, 0, round(angle, 6)))
    robot.write()

    leg = Limb("humanoid_leg", ("1_hip_yaw", "2_hip_roll", "3_hip_pitch", "4_knee", "5_ankle_pitch", "6_ankle_roll"))
    arm = Limb("humanoid_arm", ("1_shoulder_pitch", "2_shoulder_roll", "3_elbow", "4_wrist"))
    robot = Robot("humanoid", "Two legs of six joints on the base; waist, two arms of four and a neck of two above it.")
    for side in ("left", "right"):
        leg.attach(robot, f"leg_{side}", "base", [0, 0.1, -0.1], mirror=side == "right")
    robot.add("waist", "base", xyz=[0.01, 0, 0.2], rpy=[0, 0, 0], axis=[0, 0, 1])
    for side in ("left", "right"):
        arm.attach(robot, f"x_arm_{side}", "waist", [0, 0.2, 0.3], mirror=side == "right")
    robot.chain("y_neck", "waist", 2)
    robot.write()

    humanoids()

    finger = Limb("finger", ("1_spread", "2_proximal", "3_middle", "4_distal"))
    thumb = Limb("thumb", ("1_base", "2_proximal", "3_distal"))
    robot = Robot("hand", "Five fingers of four, four, four, four and three joints, on a wrist of one.")
    robot.add("a_palm", "base")
    for i, name in enumerate(("index", "middle", "ring", "small")):
        finger.attach(robot, f"f{i + 1}_{name}", "a_palm", [0.1, round(0.04 - 0.025 * i, 4), 0.01 * i], (0.02 * i, 0, 0.1))
    thumb.attach(robot, "f5_thumb", "a_palm", [0.03, 0.05, -0.01], (0.4, 0.2, 0.9))
    robot.write()


X, Y, Z = [1, 0, 0], [0, 1, 0], [0, 0, 1]


def humanoids():
    """As humanoids are built: axes along the links, right the mirror image of left; sizes to measure what size costs."""
    legs = [("1_hip_yaw", 2.5, [0, 0.1, -0.08], Z), ("2_hip_roll", 3, [0, 0, 0], X), ("3_hip_pitch", 6, [0, 0.02, -0.1], Y),
            ("4_knee", 4, [0, 0, -0.32], Y), ("5_ankle_pitch", 1.2, [0.01, 0, -0.33], Y), ("6_ankle_roll", 1.5, [0, 0, 0], X)]
    arms = [("1_shoulder_pitch", 1.5, [0, 0.18, 0.35], Y), ("2_shoulder_roll", 1.2, [0, 0.06, 0], X),
            ("3_shoulder_yaw", 1.6, [0, 0, -0.1], Z), ("4_elbow", 1.1, [0.02, 0, -0.18], Y), ("5_wrist_yaw", 0.8, [0, 0, -0.12], Z),
            ("6_wrist_pitch", 0.4, [0, 0, -0.12], Y), ("7_wrist_roll", 0.5, [0, 0, 0], X)]
    waist = [("waist_1_yaw", 2, [0, 0, 0.1], Z), ("waist_2_roll", 2, [0, 0, 0.05], X), ("waist_3_pitch", 15, [0, 0, 0.05], Y)]
    finger = [("1_proximal", 0.05, [0, 0, -0.09], Y), ("2_middle", 0.03, [0, 0, -0.04], Y), ("3_distal", 0.02, [0, 0, -0.03], Y)]

    def attach(robot, segments, prefix, parent, offset=(0, 0, 0), mirror=False):
        for i, (segment, mass, xyz, axis) in enumerate(segments):
            n = Numbers(f"humanoids {segment}")
            length = 0.06 if mass < 0.1 else 0.25
            inertial = Inertial.box(mass, [n(-0.1, 0.1) * length, n(-0.1, 0.1) * length, round(-length / 2, 4)],
                                    (0.3 * length, 0.4 * length, length), n.vector(0.1))
            xyz = [round(a + b, 4) for a, b in zip(xyz, offset)] if i == 0 else xyz
            if mirror:
                inertial, xyz, axis = inertial.mirrored(), mirrored_vector(xyz), mirrored_axis(axis)
            parent = robot.add(f"{prefix}{segment}", parent, "revolute", inertial, xyz, [0, 0, 0], axis)
        return parent

    for joints, waists, neck, fingers in ((29, 3, 0, 0), (39, 1, 0, 2), (55, 3, 2, 4)):
        robot = Robot(f"humanoid_{joints}", f"Legs of six joints, a waist of {waists}, arms of seven, a neck of {neck}, hands of "
                      f"{fingers} fingers with three: {joints} joints.", Inertial.box(10, [0, 0, 0.02], (0.2, 0.3, 0.15)))
        for side in ("left", "right"):
            attach(robot, legs, f"leg_{side}_", "base", mirror=side == "right")
        chest = attach(robot, waist[:1] if waists == 1 else waist, "", "base")
        for side in ("left", "right"):
            hand = attach(robot, arms, f"x_arm_{side}_", chest, mirror=side == "right")
            for i in range(fingers):
                attach(robot, finger, f"x_arm_{side}_8_finger_{i + 1}_", hand, [0.02, round(0.03 - 0.02 * i, 4), 0],
                       mirror=side == "right")
        attach(robot, [("1_yaw", 0.5, [0, 0, 0.4], Z), ("2_pitch", 3, [0, 0, 0.06], Y)][:neck], "y_neck_", chest)
        robot.write()


def machines():
    """As arms, quadrupeds and hands are built: axes along the links, most products of inertia zero. They are timed, in both forms
    (tests/benchmarks/forms.py)."""
    def attach(robot, segments, prefix, parent, mirror=False):
        for i, (segment, kind, mass, xyz, axis) in enumerate(segments):
            n = Numbers(f"machines {segment} {i}")
            length = 0.05 + 0.1 * math.sqrt(mass / 2)
            inertial = Inertial.box(mass, [n(-0.1, 0.1) * length, n(-0.1, 0.1) * length, round(-length / 2, 4)],
                                    (0.3 * length, 0.4 * length, length), n.vector(0.1))
            if mirror:
                inertial, xyz, axis = inertial.mirrored(), mirrored_vector(xyz), mirrored_axis(axis)
            parent = robot.add(f"{prefix}{segment}", parent, kind, inertial, xyz, [0, 0, 0], axis)
        return parent

    def turns(*rows):
        return [(name, "revolute", mass, xyz, axis) for name, mass, xyz, axis in rows]

    seven = turns(("1_yaw", 3, [0, 0, 0.15], Z), ("2_pitch", 3, [0, 0, 0.2], Y), ("3_yaw", 2.5, [0, 0, 0.2], Z),
                  ("4_pitch", 2.5, [0.08, 0, 0.2], Y), ("5_yaw", 2, [-0.08, 0, 0.2], Z), ("6_pitch", 1.5, [0, 0, 0.2], Y),
                  ("7_yaw", 0.7, [0.09, 0, 0.1], Z))
    six = turns(("1_yaw", 12, [0, 0, 0.4], Z), ("2_pitch", 10, [0.1, 0.1, 0.1], Y), ("3_pitch", 6, [0, -0.05, 0.5], Y),
                ("4_roll", 3, [0.1, 0, 0.1], X), ("5_pitch", 1.5, [0.4, 0, 0], Y), ("6_roll", 0.4, [0.1, 0, 0], X))
    box = Inertial.box(8, [0, 0, 0.02], (0.4, 0.25, 0.12))

    robot = Robot("arm_fingers", "An arm of seven joints and a gripper of two fingers that slide.", box)
    hand = attach(robot, seven, "a_", "base")
    attach(robot, [("8_slide", "prismatic", 0.02, [0, 0.01, 0.06], Y)], "b_left_", hand)
    attach(robot, [("8_slide", "prismatic", 0.02, [0, 0.01, 0.06], Y)], "b_right_", hand, mirror=True)
    robot.write()

    robot = Robot("six_axis", "An industrial arm of six joints.", box)
    attach(robot, six, "a_", "base")
    robot.write()

    robot = Robot("six_axis_positioner", "An industrial arm of six joints beside a positioner of two.", box)
    attach(robot, six, "a_", "base")
    attach(robot, turns(("1_tilt", 40, [1, 0, 0.5], Y), ("2_turn", 20, [0, 0, 0.1], Z)), "p_", "base")
    robot.write()

    robot = Robot("scara", "Two joints that turn, a slide and a wrist, all along z.", box)
    attach(robot, [("1", "revolute", 4, [0, 0, 0.3], Z), ("2", "revolute", 3, [0.3, 0, 0.1], Z),
                   ("3", "prismatic", 1, [0.25, 0, 0], Z), ("4", "revolute", 0.3, [0, 0, 0], Z)], "a_", "base")
    robot.write()

    leg = turns(("1_hip_roll", 0.7, [0, 0.05, 0], X), ("2_hip_pitch", 1.0, [0, 0.08, 0], Y), ("3_knee", 0.3, [0, 0, -0.2], Y))
    for joints, segments in ((8, leg[1:]), (12, leg)):
        robot = Robot(f"quadruped_{joints}", f"Four legs of {joints // 4} joints, axes along the body's.", box)
        for prefix, x in (("front", 0.2), ("hind", -0.2)):
            for side in ("left", "right"):
                first, *rest = segments
                placed = (first[0], first[1], first[2], [x, *first[3][1:]], first[4])
                attach(robot, [placed, *rest], f"{prefix}_{side}_", "base", mirror=side == "right")
        robot.write()

    robot = Robot("dual_arm", "A torso that turns, and two arms of seven joints on it.", box)
    torso = attach(robot, turns(("torso", 20, [0, 0, 0.3], Z)), "a_", "base")
    for side in ("left", "right"):
        shoulder = [("1_yaw", "revolute", 3, [0, 0.2, 0.3], Z), *seven[1:]]
        attach(robot, shoulder, f"b_{side}_", torso, mirror=side == "right")
    robot.write()

    robot = Robot("biped_10", "Two legs of five joints, as bipeds with springs in shins and ankles have them.", box)
    for side in ("left", "right"):
        attach(robot, turns(("1_hip_roll", 1.8, [0, 0.13, 0], X), ("2_hip_yaw", 1.2, [0, 0, -0.09], Z),
                            ("3_hip_pitch", 5.5, [0, 0, 0], Y), ("4_knee", 0.8, [0.12, 0, 0.0045], Y),
                            ("5_toe", 0.15, [0.4, 0, -0.04], Y)), f"{side}_", "base", mirror=side == "right")
    robot.write()

    robot = Robot("hand_16", "Four fingers of four joints, axes along the palm's.", box)
    for i in range(4):
        attach(robot, turns(("1_spread", 0.03, [0, 0.045 * (i - 1.5), 0.02], Z), ("2_base", 0.05, [0, 0, 0.016], Y),
                            ("3_middle", 0.04, [0, 0, 0.054], Y), ("4_tip", 0.02, [0, 0, 0.038], Y)), f"f{i + 1}_", "base")
    robot.write()


def long_limbs():
    """Of blocks that are taken limb after limb; outside of the test robots, all of which are interpreted with every quantity."""
    robot = Robot("long_limbs", "A trunk of 34 joints, on it branches of 97, 100 and 3, and one of 131 on the base.")
    end = robot.chain("a", "base", 34)
    for branch, length in (("b", 97), ("c", 100), ("d", 3)):
        robot.chain(branch, end, length)
    robot.chain("e", "base", 131)
    robot.write(FOLDER.parent / "numeric/generated")


if __name__ == "__main__":
    long_limbs()
    machines()
    chains()
    branches()
    joint_types()
    inertias()
    limbs()
