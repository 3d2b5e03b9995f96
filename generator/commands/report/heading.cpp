#include "commands/report/heading.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <ctime>
#include <fstream>
#include <string>
#include <thread>

namespace dalembert::reporting {
namespace {

// As the kernel calls it.
std::string processor() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name"))
      if (const size_t colon = line.find(": "); colon != line.npos) return line.substr(colon + 2);
  return "unknown";
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
  text("base", tree.floating_base ? "floating" : "fixed");
  number("joints", tree.joints(), "joints");
  number("nq", tree.nq(), "numbers");
  number("nv", tree.nv(), "numbers");
  number("mass", mass, "kg");
  text("command", subject.model.command_line);
  text("flags", subject.compiler.flags);
  text("mode", subject.quick ? "quick" : "full");
  text("processor", processor());
  number("cores", std::thread::hardware_concurrency(), "cores");
  text("date", fmt::format("{:%Y-%m-%d}", fmt::gmtime(std::time(nullptr))));
  text("compared_with",
       "dalembert's generic engine in double (for time) and in 50 decimal digits (for error); no other engine");
}

}  // namespace dalembert::reporting
