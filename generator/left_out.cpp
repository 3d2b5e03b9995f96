#include "left_out.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "ir/joint_words.hpp"

namespace dalembert {
namespace {

constexpr const char* phase_names[] = {"I   bodies outwards", "II  sums inwards", "III elements"};

std::string row(const std::string& name, const ir::Operations* before, const ir::Operations& after) {
  std::string line = fmt::format("{:<24}", name);
  const auto column = [&](long ir::Operations::*count) {
    if (before) line += fmt::format("{:>8} {:>7}", before->*count, after.*count);
    else line += fmt::format("{:>16}", after.*count);
  };
  column(&ir::Operations::multiply);
  column(&ir::Operations::add);
  column(&ir::Operations::sincos);
  column(&ir::Operations::divide);
  return line;
}

const OperationCost* named(const std::vector<OperationCost>& costs, const std::string& name) {
  const auto at = std::find_if(costs.begin(), costs.end(), [&](const OperationCost& c) { return c.name == name; });
  return at == costs.end() ? nullptr : &*at;
}

// All phases, then those in which something is computed.
void add_rows(std::vector<std::string>& lines, const OperationCost* before, const OperationCost& after) {
  lines.push_back(
      row(after.name == "all" ? "all together" : after.name, before ? &before->operations : nullptr, after.operations));
  for (size_t phase = 0; phase < 3; ++phase) {
    const ir::Operations* from = before ? &before->phases[phase] : nullptr;
    const auto any = [](const ir::Operations& o) { return o.total() + o.sincos > 0; };
    if (any(after.phases[phase]) || (from && any(*from)))
      lines.push_back(row(fmt::format("  {}", phase_names[phase]), from, after.phases[phase]));
  }
}

// Of indices into q or v, those of joints, counted behind the base's.
std::vector<int> behind_base(const std::vector<int>& listed, int base) {
  std::vector<int> joints;
  for (const int index : listed)
    if (index >= base) joints.push_back(index - base);
  return joints;
}

}  // namespace

std::string not_read(const OperationCost& cost, const ir::KinematicTree& tree) {
  std::vector<std::string> parts;
  const auto joints = [&](const char* what, const std::vector<int>& unread, bool some_read) {
    if (!some_read && tree.independent_joints() > 0) parts.push_back(fmt::format("joint {}", what));
    else if (!unread.empty()) parts.push_back(fmt::format("{} of {}", what, ir::joints_in_words(unread, tree)));
  };
  if (tree.base_coordinates() > 0 && !cost.reads_base_pose) parts.emplace_back("base pose");
  else if (tree.base_coordinates() > 0 && !cost.reads_base_position) parts.emplace_back("base position");
  joints("positions", ir::coordinates_at(behind_base(cost.positions_not_read, tree.base_positions()), tree),
         cost.reads_position);
  if (!cost.reads_velocity) parts.push_back("velocities");
  else joints("rates", behind_base(cost.velocities_not_read, tree.base_coordinates()), true);
  return fmt::format("{}", fmt::join(parts, ", "));
}

std::vector<std::string> left_out(const Model& model, const Lowered& lowered) {
  const std::vector<OperationCost> after = operation_costs(lowered, model.tree);
  const bool huge = too_large_to_compare(lowered);
  const std::vector<OperationCost> before = huge ? std::vector<OperationCost>{} : costs_before(model);
  std::vector<std::string> lines;
  if (huge) {
    lines.push_back("Scalar operations of one evaluation, per phase. (Nothing to compare with: the robot is too large.)");
    lines.push_back(fmt::format("{:<24}{:>16}{:>16}{:>16}{:>16}", "", "multiply", "add", "sin/cos", "divide"));
  } else if (before.empty()) {
    lines.push_back(
        "Scalar operations of one evaluation, per phase. (Nothing to compare with: without the scene the URDF cannot");
    lines.push_back("be computed.)");
    lines.push_back(fmt::format("{:<24}{:>16}{:>16}{:>16}{:>16}", "", "multiply", "add", "sin/cos", "divide"));
  } else {
    lines.push_back(
        "Scalar operations of one evaluation, per phase. Before: the URDF without a scene, as the equations are written");
    lines.push_back(
        "(--without fold,share,move_parameters), with the default outputs and those asked for. Here: what is left.");
    lines.push_back(fmt::format("{:<24}{:>16}{:>16}{:>16}{:>16}", "", "multiply", "add", "sin/cos", "divide"));
    std::string heading(24, ' ');
    for (int i = 0; i < 4; ++i) heading += fmt::format("{:>8} {:>7}", "before", "here");
    lines.push_back(heading);
  }
  for (const OperationCost& cost : after) add_rows(lines, named(before, cost.name), cost);
  for (const auto& [function, operations] : executed_operations(model, lowered))
    lines.push_back(row(function + ", executed", nullptr, operations));
  std::vector<std::string> left_out;
  for (const OperationCost& cost : before)
    if (!named(after, cost.name)) left_out.push_back(cost.name);
  if (!left_out.empty()) lines.push_back(fmt::format("Left out: {}", fmt::join(left_out, ", ")));
  const std::string unread_at_all = not_read(after.front(), model.tree);
  for (const OperationCost& cost : after)
    if (const std::string unread = not_read(cost, model.tree);
        !unread.empty() && (&cost == &after.front() || unread != unread_at_all))
      lines.push_back(fmt::format("Not read {}: {}", cost.name == "all" ? "at all" : "by " + cost.name, unread));
  const std::vector<const LoweredSection*> sections = lowered.all_sections();
  const bool rolled =
      std::any_of(sections.begin(), sections.end(), [](const LoweredSection* s) { return s->plan.form == ir::Form::rolled; });
  lines.push_back(rolled
                      ? "Executed: by the rolled code, whose loops compute padding, to four lanes, and zeros and ones as well."
                      : "Executed: by the code, which computes sines four at a time.");
  lines.push_back(fmt::format("Workspace: {} bytes", workspace_bytes(model, lowered)));
  return lines;
}

}  // namespace dalembert
