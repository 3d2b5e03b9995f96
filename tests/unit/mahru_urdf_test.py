"""mahru.urdf is what its comment says: size, mass, symmetry, solids. Reads the file itself, without the project's front end."""

import math
import sys
import unittest
import xml.etree.ElementTree as ET


def numbers(element, attribute, default="0 0 0"):
    return [float(x) for x in (element.get(attribute, default) if element is not None else default).split()]


def solid_inertia(mass, geometry):
    """Principal moments of a homogeneous solid about its centre, along its axes, kg m²."""
    solid = geometry[0]
    if solid.tag == "box":
        x, y, z = numbers(solid, "size")
        return [mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)]
    r = float(solid.get("radius"))
    if solid.tag == "cylinder":
        across = mass / 12 * (3 * r * r + float(solid.get("length")) ** 2)
        return [across, across, mass * r * r / 2]
    return [0.4 * mass * r * r] * 3


def half_height(geometry):
    solid = geometry[0]
    if solid.tag == "box":
        return numbers(solid, "size")[2] / 2
    return float(solid.get("length")) / 2 if solid.tag == "cylinder" else float(solid.get("radius"))


class Mahru(unittest.TestCase):
    def setUp(self):
        robot = ET.parse(sys.argv[1]).getroot()
        self.links = {link.get("name"): link for link in robot.findall("link")}
        self.joints = {joint.get("name"): joint for joint in robot.findall("joint")}
        self.moving = {n: j for n, j in self.joints.items() if j.get("type") == "revolute"}

    def test_joints(self):
        """25 revolute joints about a coordinate axis: 6 per leg, 6 per arm, 1 in the waist; the head is fixed; no frame is turned."""
        leg = ["hip_yaw", "hip_roll", "hip_pitch", "knee", "ankle_pitch", "ankle_roll"]
        arm = ["shoulder_pitch", "shoulder_roll", "shoulder_yaw", "elbow", "wrist_yaw", "wrist_pitch"]
        names = {f"{side}_{joint}" for side in ("left", "right") for joint in leg + arm} | {"waist"}
        self.assertEqual(set(self.moving), names)
        self.assertEqual(set(self.joints) - names, {"neck"})
        for joint in self.joints.values():
            self.assertEqual(numbers(joint.find("origin"), "rpy"), [0, 0, 0])
        for joint in self.moving.values():
            self.assertEqual(sorted(numbers(joint.find("axis"), "xyz")), [0, 0, 1])
            limit = joint.find("limit")
            self.assertLessEqual(float(limit.get("lower")), 0)
            self.assertGreaterEqual(float(limit.get("upper")), 0)

    def test_mass(self):
        self.assertAlmostEqual(sum(float(link.find("inertial/mass").get("value")) for link in self.links.values()), 65, places=9)

    def test_height(self):
        """At zero all link frames are parallel, so heights add up."""
        above = {"pelvis": 0.0}
        while len(above) < len(self.links):
            for joint in self.joints.values():
                parent, child = joint.find("parent").get("link"), joint.find("child").get("link")
                if parent in above:
                    above[child] = above[parent] + numbers(joint.find("origin"), "xyz")[2]
        top = bottom = 0.0
        for name, link in self.links.items():
            visual = link.find("visual")
            centre, half = above[name] + numbers(visual.find("origin"), "xyz")[2], half_height(visual.find("geometry"))
            top, bottom = max(top, centre + half), min(bottom, centre - half)
        self.assertAlmostEqual(top - bottom, 1.40, places=9)
        self.assertAlmostEqual(bottom, -0.70, places=9)

    def test_solids(self):
        """Every inertia is that of the link's visual and collision solid (six digits), hence physically valid."""
        for name, link in self.links.items():
            with self.subTest(link=name):
                inertial, visual, collision = link.find("inertial"), link.find("visual"), link.find("collision")
                for part in (visual, collision):
                    self.assertEqual(numbers(part.find("origin"), "xyz"), numbers(inertial.find("origin"), "xyz"))
                    self.assertEqual(ET.tostring(part.find("geometry")).strip(), ET.tostring(visual.find("geometry")).strip())
                mass, inertia = float(inertial.find("mass").get("value")), inertial.find("inertia")
                moments = [float(inertia.get(key)) for key in ("ixx", "iyy", "izz")]
                for value, expected in zip(moments, solid_inertia(mass, visual.find("geometry"))):
                    self.assertTrue(math.isclose(value, expected, rel_tol=1e-5), f"{value} is not {expected}")
                self.assertEqual([float(inertia.get(key)) for key in ("ixy", "ixz", "iyz")], [0, 0, 0])
                self.assertGreater(min(moments), 0)
                self.assertGreater(sum(moments), 2 * max(moments))

    def test_mirror(self):
        """Right is left mirrored in y = 0: y changes sign, and so do angles about x and z."""
        def mirrored(vector):
            return [vector[0], -vector[1], vector[2]]

        for name, left in self.links.items():
            if name.startswith("left_"):
                with self.subTest(link=name):
                    right = self.links[name.replace("left_", "right_", 1)]
                    for part in ("inertial", "visual", "collision"):
                        self.assertEqual(numbers(right.find(f"{part}/origin"), "xyz"), mirrored(numbers(left.find(f"{part}/origin"), "xyz")))
                    for part in ("inertial/mass", "inertial/inertia", "visual/geometry/*", "collision/geometry/*"):
                        self.assertEqual(right.find(part).attrib, left.find(part).attrib)
            elif not name.startswith("right_"):
                self.assertEqual(numbers(self.links[name].find("inertial/origin"), "xyz")[1], 0)
        for name, left in self.moving.items():
            if name.startswith("left_"):
                with self.subTest(joint=name):
                    right = self.moving[name.replace("left_", "right_", 1)]
                    self.assertEqual(numbers(right.find("origin"), "xyz"), mirrored(numbers(left.find("origin"), "xyz")))
                    self.assertEqual(numbers(right.find("axis"), "xyz"), numbers(left.find("axis"), "xyz"))
                    l, r = ({k: float(x) for k, x in joint.find("limit").attrib.items()} for joint in (left, right))
                    if numbers(left.find("axis"), "xyz") != [0, 1, 0]:
                        l["lower"], l["upper"] = -l["upper"], -l["lower"]
                    self.assertEqual(l, r)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
