#include "commands/report/heading.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <thread>

#include "commands/machine.hpp"
#include "reference/trajectory.hpp"

namespace dalembert::reporting {
namespace {

bool any_output(const Subject& subject) {
  return std::any_of(subject.outputs.begin(), subject.outputs.end(),
                     [&](const Output& output) { return subject.mujoco.obstacle(output).empty(); });
}

// Or why not with it, and how to have it.
std::string with_mujoco(const Subject& subject) {
  const Mujoco& mujoco = subject.mujoco;
  if (!mujoco.found())
    return fmt::format(
        "; not with MuJoCo, which is not found ({}): install Debian's libmujoco-dev, or name its folders with "
        "--flags (-I, -L and -Wl,-rpath)",
        mujoco.why_not_found());
  if (any_output(subject)) return ", MuJoCo " + mujoco.version();
  return fmt::format("; not with MuJoCo {}: {}", mujoco.version(), mujoco.obstacle(subject.outputs.front()));
}

std::string with_pinocchio(const Subject& subject) {
  if (!subject.pinocchio.found()) return "";
  return fmt::format(", Pinocchio {} ({})", subject.pinocchio.version(), subject.pinocchio.compiled());
}

// Every program whose figures stand beside ours.
std::string compared_with(const Subject& subject) {
  return fmt::format("dalembert's generic engine in 50 decimal digits (for error) and in double, {} (for trajectories){}{}",
                     reference::trajectory_program(), with_pinocchio(subject), with_mujoco(subject));
}

}  // namespace

void add_heading(const Subject& subject, Rows& rows) {
  const ir::KinematicTree& tree = subject.model.tree;
  double mass = tree.base.mass;
  for (const ir::Body& body : tree.bodies) mass += body.inertia.mass;
  const auto text = [&](const char* metric, const std::string& value) {
    rows.text("robot", tree.robot, "", "", metric, value);
  };
  const auto number = [&](const char* metric, double value, const char* unit) {
    rows.number("robot", tree.robot, "", "", metric, value, unit);
  };
  text("base", ir::row_of(tree.base_joint).word);
  number("joints", tree.joints(), "joints");
  number("nq", tree.nq(), "numbers");
  number("nv", tree.nv(), "numbers");
  number("mass", mass, "kg");
  text("command", subject.model.command_line);
  text("flags", subject.compiler.flags);
  text("mode", subject.quick ? "quick" : "full");
  text("processor", this_machine().text());
  number("cores", std::thread::hardware_concurrency(), "cores");
  text("date", fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))));
  text("compared_with", compared_with(subject));
}

}  // namespace dalembert::reporting
