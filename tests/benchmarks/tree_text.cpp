#include "tree_text.hpp"

#include <fmt/format.h>

#include <cmath>

namespace dalembert::benchmarks {
namespace {

std::string link_text(const std::string& name, int number, double mass, double length) {
  // Principal moments of a bar 0.3 × 0.06 × 0.08 m, turned a little: physically valid, all six elements present.
  const double shade = 1 + 0.01 * (number % 7), moment = mass * length * length;
  return fmt::format(
      "  <link name=\"{}\">\n    <inertial>\n"
      "      <origin xyz=\"{:.9g} {:.9g} {:.9g}\" rpy=\"0 0 0\"/>\n"
      "      <mass value=\"{:.9g}\"/>\n"
      "      <inertia ixx=\"{:.9g}\" ixy=\"{:.9g}\" ixz=\"{:.9g}\" iyy=\"{:.9g}\" iyz=\"{:.9g}\" izz=\"{:.9g}\"/>\n"
      "    </inertial>\n  </link>\n",
      name, 0.15 * length, 0.01 * length, -0.02 * length, 2 * shade * mass, 0.0018 * shade * moment, 0.0004 * moment,
      -0.0003 * moment, 0.0161 * shade * moment, 0.0002 * moment, 0.0157 * shade * moment);
}

std::string joint_text(const std::string& parent, const std::string& child, double x, double z, double yaw, const char* axis) {
  return fmt::format(
      "  <joint name=\"joint_{1}\" type=\"revolute\">\n    <parent link=\"{0}\"/>\n    <child link=\"{1}\"/>\n"
      "    <origin xyz=\"{2:.9g} 0 {3:.9g}\" rpy=\"0 0 {4:.6f}\"/>\n    <axis xyz=\"{5}\"/>\n"
      "    <limit lower=\"-3\" upper=\"3\" effort=\"100\" velocity=\"10\"/>\n  </joint>\n",
      parent, child, x, z, yaw, axis);
}

}  // namespace

std::string tree_text(int joints, int branches, double masses, double lengths) {
  std::string text = fmt::format("<?xml version=\"1.0\"?>\n<robot name=\"tree_{}_{}\">\n", joints, branches);
  text += link_text("base", 0, 1, 1);
  const char* const axes[] = {"0 0 1", "0 1 0", "1 0 0"};
  const int length = joints / branches;
  for (int branch = 0; branch < branches; ++branch) {
    std::string parent = "base";
    double above = 1;  // the parent's length
    for (int i = 0; i < length; ++i) {
      const std::string link = fmt::format("b{:02}_{:03}", branch, i);
      const double part = static_cast<double>(i + 1) / length, scale = std::pow(lengths, part);
      text += link_text(link, i + 1, std::pow(masses, part), scale);
      const double turn = i == 0 ? 6.283185 * branch / branches : 0;  // the branches point away from each other
      text += joint_text(parent, link, (i == 0 ? 0.1 : 0.3) * above, 0.02 * above, turn, axes[i % 3]);
      parent = link;
      above = scale;
    }
  }
  return text + "</robot>\n";
}

}  // namespace dalembert::benchmarks
