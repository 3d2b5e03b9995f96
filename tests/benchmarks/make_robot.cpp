// Writes the URDF of a tree of equal branches to standard output; one branch makes a chain.
//
//   make_robot JOINTS BRANCHES [MASSES LENGTHS]
//
// The paper's second experiment sweeps these. Every link is a bar of 2 kg along x with
// a generic, turned inertia, so that no structural zero flatters anyone; axes go z, y, x, z, ... down each branch. MASSES and
// LENGTHS make extremes: the last link's mass and length as a multiple of the base's, those between growing geometrically.
#include <cmath>
#include <cstdio>
#include <cstdlib>

namespace {

void print_link(const char* name, int number, double mass, double length) {
  // Principal moments of a bar 0.3 × 0.06 × 0.08 m, turned a little: physically valid, all six elements present.
  const double shade = 1 + 0.01 * (number % 7), moment = mass * length * length;
  std::printf("  <link name=\"%s\">\n    <inertial>\n", name);
  std::printf("      <origin xyz=\"%.9g %.9g %.9g\" rpy=\"0 0 0\"/>\n", 0.15 * length, 0.01 * length, -0.02 * length);
  std::printf("      <mass value=\"%.9g\"/>\n", 2 * shade * mass);
  std::printf("      <inertia ixx=\"%.9g\" ixy=\"%.9g\" ixz=\"%.9g\" iyy=\"%.9g\" iyz=\"%.9g\" izz=\"%.9g\"/>\n",
              0.0018 * shade * moment, 0.0004 * moment, -0.0003 * moment, 0.0161 * shade * moment, 0.0002 * moment,
              0.0157 * shade * moment);
  std::printf("    </inertial>\n  </link>\n");
}

void print_joint(const char* name, const char* parent, const char* child, double x, double z, double yaw, const char* axis) {
  std::printf("  <joint name=\"%s\" type=\"revolute\">\n    <parent link=\"%s\"/>\n    <child link=\"%s\"/>\n", name, parent,
              child);
  std::printf("    <origin xyz=\"%.9g 0 %.9g\" rpy=\"0 0 %.6f\"/>\n    <axis xyz=\"%s\"/>\n", x, z, yaw, axis);
  std::printf("    <limit lower=\"-3\" upper=\"3\" effort=\"100\" velocity=\"10\"/>\n  </joint>\n");
}

}  // namespace

int main(int argc, char** argv) {
  const bool extreme = argc == 5;
  const int joints = argc == 3 || extreme ? std::atoi(argv[1]) : 0, branches = joints ? std::atoi(argv[2]) : 0;
  const double masses = extreme ? std::atof(argv[3]) : 1, lengths = extreme ? std::atof(argv[4]) : 1;
  if (joints < 1 || branches < 1 || joints % branches != 0 || !(masses > 0) || !(lengths > 0)) {
    std::fprintf(stderr, "make_robot JOINTS BRANCHES [MASSES LENGTHS]: positive numbers, the first a multiple of the second\n");
    return 2;
  }
  std::printf("<?xml version=\"1.0\"?>\n<robot name=\"tree_%d_%d\">\n", joints, branches);
  print_link("base", 0, 1, 1);
  const char* const axes[] = {"0 0 1", "0 1 0", "1 0 0"};
  const int length = joints / branches;
  for (int branch = 0; branch < branches; ++branch) {
    char parent[32] = "base";
    double above = 1;  // the parent's length
    for (int i = 0; i < length; ++i) {
      char link[32], joint[32];
      std::snprintf(link, sizeof link, "b%02d_%03d", branch, i);
      std::snprintf(joint, sizeof joint, "joint_b%02d_%03d", branch, i);
      const double part = static_cast<double>(i + 1) / length, scale = std::pow(lengths, part);
      print_link(link, i + 1, std::pow(masses, part), scale);
      const double turn = i == 0 ? 6.283185 * branch / branches : 0;  // the branches point away from each other
      print_joint(joint, parent, link, (i == 0 ? 0.1 : 0.3) * above, 0.02 * above, turn, axes[i % 3]);
      std::snprintf(parent, sizeof parent, "%s", link);
      above = scale;
    }
  }
  std::printf("</robot>\n");
}
