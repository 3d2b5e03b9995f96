// Writes the URDF of a tree of equal branches to standard output: make_robot JOINTS BRANCHES (one branch: a chain).
//
// The paper's second experiment (algorithm.md §5 of the design notes) sweeps these. Every link is a bar of 2 kg along x with
// a generic, turned inertia, so that no structural zero flatters anyone; axes go z, y, x, z, ... down each branch.
#include <cstdio>
#include <cstdlib>

namespace {

void print_link(const char* name, int number) {
  // Principal moments of a bar 0.3 × 0.06 × 0.08 m, turned a little: physically valid, all six elements present.
  const double shade = 1 + 0.01 * (number % 7);
  std::printf("  <link name=\"%s\">\n    <inertial>\n      <origin xyz=\"0.15 0.01 -0.02\" rpy=\"0 0 0\"/>\n", name);
  std::printf("      <mass value=\"%.3f\"/>\n", 2 * shade);
  std::printf("      <inertia ixx=\"%.6f\" ixy=\"0.0004\" ixz=\"-0.0003\" iyy=\"%.6f\" iyz=\"0.0002\" izz=\"%.6f\"/>\n",
              0.0018 * shade, 0.0161 * shade, 0.0157 * shade);
  std::printf("    </inertial>\n  </link>\n");
}

void print_joint(const char* name, const char* parent, const char* child, double x, double yaw, const char* axis) {
  std::printf("  <joint name=\"%s\" type=\"revolute\">\n    <parent link=\"%s\"/>\n    <child link=\"%s\"/>\n", name, parent,
              child);
  std::printf("    <origin xyz=\"%.3f 0 0.02\" rpy=\"0 0 %.6f\"/>\n    <axis xyz=\"%s\"/>\n", x, yaw, axis);
  std::printf("    <limit lower=\"-3\" upper=\"3\" effort=\"100\" velocity=\"10\"/>\n  </joint>\n");
}

}  // namespace

int main(int argc, char** argv) {
  const int joints = argc == 3 ? std::atoi(argv[1]) : 0, branches = argc == 3 ? std::atoi(argv[2]) : 0;
  if (joints < 1 || branches < 1 || joints % branches != 0) {
    std::fprintf(stderr, "make_robot JOINTS BRANCHES: two positive numbers, the first a multiple of the second\n");
    return 2;
  }
  std::printf("<?xml version=\"1.0\"?>\n<robot name=\"tree_%d_%d\">\n", joints, branches);
  print_link("base", 0);
  const char* const axes[] = {"0 0 1", "0 1 0", "1 0 0"};
  const int length = joints / branches;
  for (int branch = 0; branch < branches; ++branch) {
    char parent[32] = "base";
    for (int i = 0; i < length; ++i) {
      char link[32], joint[32];
      std::snprintf(link, sizeof link, "b%02d_%03d", branch, i);
      std::snprintf(joint, sizeof joint, "joint_b%02d_%03d", branch, i);
      print_link(link, i + 1);
      const double turn = i == 0 ? 6.283185 * branch / branches : 0;  // the branches point away from each other
      print_joint(joint, parent, link, i == 0 ? 0.1 : 0.3, turn, axes[i % 3]);
      std::snprintf(parent, sizeof parent, "%s", link);
    }
  }
  std::printf("</robot>\n");
}
