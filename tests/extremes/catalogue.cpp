#include "catalogue.hpp"

#include <fmt/format.h>

#include <cmath>
#include <functional>

namespace dalembert::extremes {
namespace {

// A bar along x, as multiples of 2 kg and 0.3 m; `inertia` of its rotational inertia. Massless: none of the three.
struct Link {
  double mass = 1, length = 1, inertia = 1;
  bool massless = false;
  double next = 1;  // where the next joint sits, in lengths
};

std::string link_text(const std::string& name, const Link& link, int number) {
  if (link.massless) return fmt::format("  <link name=\"{}\"/>\n", name);
  // Principal moments of a bar 0.3 x 0.06 x 0.08 m, turned a little: physically valid, all six elements present.
  const double shade = 1 + 0.01 * (number % 7), moment = link.mass * link.length * link.length * link.inertia;
  return fmt::format(
      "  <link name=\"{}\"><inertial><origin xyz=\"{} {} {}\"/><mass value=\"{}\"/>"
      "<inertia ixx=\"{}\" ixy=\"{}\" ixz=\"{}\" iyy=\"{}\" iyz=\"{}\" izz=\"{}\"/></inertial></link>\n",
      name, 0.15 * link.length, 0.01 * link.length, -0.02 * link.length, 2 * shade * link.mass, 0.0018 * shade * moment,
      0.0004 * moment, -0.0003 * moment, 0.0161 * shade * moment, 0.0002 * moment, 0.0157 * shade * moment);
}

// A chain: `link(i)` is the i-th from the base, which is the 0th; axes go z, y, x, z, … unless all are y.
std::string chain(int joints, const std::function<Link(int)>& link, bool planar = false) {
  std::string text = "<?xml version=\"1.0\"?>\n<robot name=\"chain\">\n" + link_text("link_0", link(0), 0);
  const char* const axes[] = {"0 0 1", "0 1 0", "1 0 0"};
  for (int i = 1; i <= joints; ++i) {
    const Link above = link(i - 1);
    text += link_text(fmt::format("link_{}", i), link(i), i);
    text += fmt::format(
        "  <joint name=\"joint_{0}\" type=\"revolute\"><parent link=\"link_{1}\"/><child link=\"link_{0}\"/>"
        "<origin xyz=\"{2} 0 {3}\"/><axis xyz=\"{4}\"/>"
        "<limit lower=\"-3\" upper=\"3\" effort=\"100\" velocity=\"10\"/></joint>\n",
        i, i - 1, 0.3 * above.length * above.next, planar ? 0 : 0.02 * above.length, planar ? "0 1 0" : axes[(i - 1) % 3]);
  }
  return text + "</robot>\n";
}

// From 1 at the base to `last` at the tip, geometrically.
double grown(double last, int i, int joints) { return std::pow(last, static_cast<double>(i) / joints); }

Robot growing(const char* name, const char* what, double mass, double length, double inertia) {
  return {name, what, chain(10, [=](int i) {
            return Link{grown(mass, i, 10), grown(length, i, 10), grown(inertia, i, 10), false, 1};
          })};
}

}  // namespace

std::vector<Robot> robots() {
  std::vector<Robot> list;
  list.push_back({"ordinary", "10 joints, equal links: to compare with", chain(10, [](int) { return Link{}; }), true});
  list.push_back(growing("mass_up", "links growing to 1e9 of the base's mass", 1e9, 1, 1));
  list.push_back(growing("mass_down", "links shrinking to 1e-9 of the base's mass", 1e-9, 1, 1));
  list.push_back(growing("length_up", "links growing to 1e6 of the base's length", 1, 1e6, 1));
  list.push_back(growing("length_down", "links shrinking to 1e-6 of the base's length", 1, 1e-6, 1));
  list.push_back(growing("inertia_up", "rotational inertias growing to 1e6 of normal", 1, 1, 1e6));
  list.push_back(growing("inertia_down", "rotational inertias shrinking to 1e-6 of normal", 1, 1, 1e-6));
  list.push_back({"all_large", "every length 1e6 of normal", chain(10, [](int) { return Link{1, 1e6}; })});
  list.push_back({"all_small", "every length 1e-6 of normal", chain(10, [](int) { return Link{1, 1e-6}; })});
  list.push_back({"massless", "every second link without mass", chain(9, [](int i) {
                    return Link{1, 1, 1, i % 2 == 1 && i < 9};
                  })});
  list.push_back({"far_joint", "a link of 2 t whose next joint lies 100 m along it", chain(4, [](int i) {
                    return i == 2 ? Link{1e3, 1, 1, false, 1000 / 3.0} : Link{};
                  })});
  list.push_back({"far_base", "the first joint 100 m from a floating base",
                  chain(4,
                        [](int i) {
                          return i == 0 ? Link{1, 1, 1, false, 1000 / 3.0} : Link{};
                        }),
                  true, 256,
                  "C refers to the base\'s frame, where the links\' own parts are what arms of 100 m leave of each other"});
  list.push_back({"series_mass", "two hinges in series, the second link 1e9 times heavier",
                  chain(
                      2, [](int i) { return Link{i == 2 ? 1e9 : 1}; }, true)});
  list.push_back({"inertia_ratio", "a double pendulum, the second link's inertia 1e9 times the first's",
                  chain(
                      2,
                      [](int i) {
                        return Link{1, 1, i == 2 ? 1e9 : 1};
                      },
                      true)});
  for (int joints : {30, 100, 300, 1000}) {
    Robot robot{fmt::format("chain_{}", joints), fmt::format("{} joints, equal links", joints),
                chain(joints, [](int) { return Link{}; })};
    robot.slow = joints > 30;
    if (joints == 1000) robot.ulp = 256, robot.why = "the rounding of a thousand turns in a row adds up";
    list.push_back(robot);
  }
  return list;
}

}  // namespace dalembert::extremes
