#include "commands/info.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "backend/estimate.hpp"
#include "commands/json.hpp"
#include "commands/labels.hpp"
#include "commands/output.hpp"
#include "commands/timing.hpp"
#include "compile.hpp"
#include "ir/constraint_words.hpp"
#include "ir/moved_links.hpp"
#include "ir/plan_words.hpp"
#include "left_out.hpp"

namespace dalembert {

namespace {

// -0 and 0 print alike.
std::string vector(const Eigen::Vector3d& v) {
  return fmt::format("{:.6g} {:.6g} {:.6g}", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0);
}

std::string summary(const Model& model) {
  const ir::KinematicTree& tree = model.tree;
  double mass = tree.base.mass;
  for (const ir::Body& body : tree.bodies) mass += body.inertia.mass;
  return fmt::format(
      "robot {} ({}): {} base '{}', {} moving joints, {} links, {:.6g} kg that move\n"
      "nq = {}, nv = {}\n",
      tree.robot, model.name, ir::row_of(tree.base_joint).word, tree.base_link,
      std::count_if(tree.bodies.begin(), tree.bodies.end(), [](const ir::Body& body) { return body.part == 0; }),
      tree.links.size(), mass, tree.nq(), tree.nv());
}

bool any_of_several(const ir::KinematicTree& tree) {
  return std::any_of(tree.bodies.begin(), tree.bodies.end(), [](const ir::Body& body) { return body.parts > 1; });
}

std::string coordinates(const ir::KinematicTree& tree) {
  std::string rows;  // of joints whose numbers are not one of q and one of v, in the same order
  const std::vector<int> position = tree.positions(), coordinate = tree.coordinates();
  for (size_t k = 0; k < tree.bodies.size() && any_of_several(tree); ++k) {
    const ir::Body& body = tree.bodies[k];
    if (body.part > 0 || body.driven() || body.follows) continue;
    const ir::JointTypeRow& kind = ir::row_of(body.type_of_joint());
    const auto range = [](const char* of, int first, int count) {
      return count == 1 ? fmt::format("{}[{}]", of, first) : fmt::format("{}[{}-{}]", of, first, first + count - 1);
    };
    rows += fmt::format("  {}: {}, {}; {}\n", body.of.empty() ? body.joint : body.of,
                        range("q", tree.base_positions() + position[k], kind.nq),
                        range("v", tree.base_coordinates() + coordinate[k], kind.nv), kind.coordinates);
  }
  if (tree.base_coordinates() == 0) return "q = [joints], v = [joint rates]\n" + rows;
  return "q = [base position in the world (0-2), quaternion x y z w (3-6), joints (7-)]\n"
         "v = [base linear velocity (0-2), angular velocity (3-5), both in base axes, joint rates (6-)]\n" +
         rows;
}

// What the scene puts into a joint.
std::string losses_and_springs(const ir::Body& body) {
  std::string text;
  if (body.armature != 0) text += fmt::format(", armature {:.6g}", body.armature);
  if (body.damping != 0) text += fmt::format(", damping {:.6g}", body.damping);
  if (body.friction != 0) text += fmt::format(", friction {:.6g}", body.friction);
  if (body.spring.k != 0) text += fmt::format(", spring {:.6g} at rest at {:.6g}", body.spring.k, body.spring.rest);
  return text;
}

// The axis of the joint that moves body k; of several coordinates, theirs.
std::string axes_of(const ir::KinematicTree& tree, size_t k) {
  std::string text;
  for (size_t i = k; i < k + static_cast<size_t>(tree.bodies[k].parts); ++i)
    text += (text.empty() ? "" : " | ") + vector(tree.bodies[i].axis);
  return text;
}

std::string bodies(const ir::KinematicTree& tree) {
  std::string text = "\ntree (joint: type, axis -> body, mass, and what the scene puts into the joint):\n";
  text += fmt::format("  base {}{}\n", tree.base_link,
                      tree.base_coordinates() > 0 ? fmt::format(", {:.6g} kg", tree.base.mass) : "");
  const std::vector<int> coordinate = tree.coordinates();
  std::vector<int> depth(tree.bodies.size());
  for (size_t k = 0; k < tree.bodies.size(); ++k) {
    const ir::Body& body = tree.bodies[k];
    const int above = body.parent < 0 ? 0 : depth[static_cast<size_t>(body.parent)];
    depth[k] = body.part == 0 ? above + 1 : above;
    if (body.part > 0) continue;  // said with the first
    const ir::Body& moved = tree.bodies[k + static_cast<size_t>(body.parts) - 1];
    const std::string number = body.driven()
                                   ? fmt::format("= {:.6g} q[{}] + {:.6g}", body.multiplier, coordinate[k], body.offset)
                               : body.follows   ? "follows"
                               : body.parts > 1 ? fmt::format("{}-{}", coordinate[k], coordinate[k] + body.parts - 1)
                                                : fmt::format("{}", coordinate[k]);
    text += fmt::format("  {:>{}}{} {}: {}, {}{} -> {}, {:.6g} kg{}\n", "", 2 * depth[k], number,
                        body.of.empty() ? body.joint : body.of, ir::row_of(body.type_of_joint()).word, axes_of(tree, k),
                        body.is_screw() ? fmt::format(", {:.6g} m per turn", body.pitch) : "", moved.name, moved.inertia.mass,
                        losses_and_springs(body));
  }
  return text;
}

// Who follows whom by loops.
std::string linkages(const ir::KinematicTree& tree) {
  if (tree.linkages.empty()) return "";
  std::string text = "\nembedded loops (q has every joint; v, accelerations and forces are of the independent ones):\n";
  const auto names = [&](const std::vector<int>& bodies) {
    std::vector<std::string> all;
    for (const int k : bodies) all.push_back(tree.bodies[static_cast<size_t>(k)].joint);
    return fmt::format("{}", fmt::join(all, ", "));
  };
  for (const ir::Linkage& linkage : tree.linkages) {
    std::vector<std::string> loops;
    int rows = 0;
    for (const ir::LinkageLoop& loop : linkage.loops) loops.push_back(loop.name), rows += loop.rows();
    text += fmt::format("  {}, {} row{}: {} follow{} {}\n", fmt::join(loops, ", "), rows, rows == 1 ? "" : "s",
                        names(linkage.dependent), linkage.dependent.size() == 1 ? "s" : "", names(linkage.independent));
  }
  return text;
}

std::string links(const ir::KinematicTree& tree) {
  std::string text = "\nlinks (link: body, position in the body's frame in m):\n";
  for (const ir::LinkPlacement& link : tree.links) {
    if (!link.on.empty()) continue;
    const std::string& body = link.body < 0 ? tree.base_link : tree.bodies[static_cast<size_t>(link.body)].name;
    text +=
        fmt::format("  {}: {}, {}\n", link.link, link.body < 0 ? "base " + body : body, vector(link.placement.translation()));
  }
  return text;
}

std::string frames(const ir::Scene& scene) {
  if (scene.placed.empty()) return "";
  std::string text = "\nframes of the scene (frame: link, position in the link's frame in m, roll pitch yaw in rad):\n";
  for (const ir::Frame& frame : scene.placed)
    text += fmt::format("  {}: {}, {}, {}\n", frame.name, frame.link, vector(frame.xyz), vector(frame.rpy));
  return text;
}

// Whose rows are whose, in the order of rows.
struct OwnRows {
  std::string name, type, of;
  int first = 0, count = 0;
};
std::vector<OwnRows> rows_of_constraints(const ir::Scene& scene) {
  std::vector<OwnRows> all;
  for (const ir::Contact& c : scene.contacts) all.push_back({c.name, word_of(ir::contact_words(), c.type), "", 0, 0});
  for (const ir::Loop& l : scene.loops) all.push_back({l.name, word_of(ir::loop_words(), l.type), "", 0, 0});
  const std::vector<ir::Constraint> constraints = scene.constraints();
  all.resize(constraints.size());
  int row = 0;
  for (size_t i = 0; i < constraints.size(); row += constraints[i++].rows)
    all[i].of = constraints[i].of, all[i].first = row, all[i].count = constraints[i].rows;
  return all;
}

std::string contacts_and_loops(const ir::Scene& scene) {
  if (!scene.any_constraint()) return "";
  std::string text = "\ncontacts and loops (name: type, link, rows of the constraints):\n";
  for (const OwnRows& c : rows_of_constraints(scene))
    text += fmt::format(
        "  {}: {}, {}, {}\n", c.name, c.type, c.of,
        c.count == 1 ? fmt::format("row {}", c.first) : fmt::format("rows {} to {}", c.first, c.first + c.count - 1));
  return text;
}

std::string constraints_json(const ir::Scene& scene) {
  std::string text;
  for (const OwnRows& c : rows_of_constraints(scene))
    text += fmt::format("{}\n    {}: {{\"type\": {}, \"of\": {}, \"first_row\": {}, \"rows\": {}}}", text.empty() ? "" : ",",
                        json_string(c.name), json_string(c.type), json_string(c.of), c.first, c.count);
  return text.empty() ? "" : fmt::format("  \"constraints\": {{{}\n  }},\n", text);
}

// Row and column i, k of M are structurally non-zero when one body is the other's ancestor; the base is everyone's.
std::string sparsity(const ir::KinematicTree& tree) {
  const size_t nv = static_cast<size_t>(tree.nv()), base = tree.base_coordinates();
  const std::vector<int> coordinate = tree.coordinates();
  std::vector<std::vector<bool>> filled(nv, std::vector<bool>(nv, false));
  for (size_t i = 0; i < base; ++i)
    for (size_t k = 0; k < nv; ++k) filled[i][k] = filled[k][i] = true;
  // Those that move a joint: its own, or what it follows by loops.
  const auto moving = [&](size_t k) {
    std::vector<size_t> own;
    if (coordinate[k] >= 0) own.push_back(base + static_cast<size_t>(coordinate[k]));
    for (const ir::Linkage& linkage : tree.linkages)
      if (std::count(linkage.dependent.begin(), linkage.dependent.end(), static_cast<int>(k)) > 0)
        for (const int followed : linkage.independent)
          own.push_back(base + static_cast<size_t>(coordinate[static_cast<size_t>(followed)]));
    return own;
  };
  size_t pairs = 0;
  for (size_t k = 0; k < tree.bodies.size(); ++k)
    for (int i = static_cast<int>(k); i >= 0; i = tree.bodies[static_cast<size_t>(i)].parent) {
      for (const size_t row : moving(static_cast<size_t>(i)))
        for (const size_t column : moving(k)) filled[row][column] = filled[column][row] = true;
      if (static_cast<size_t>(i) != k) ++pairs;
    }
  size_t elements = 0;
  for (const std::vector<bool>& row : filled) elements += static_cast<size_t>(std::count(row.begin(), row.end(), true));
  return fmt::format("\nsparsity: {} of {} elements of M are structurally non-zero; {} pairs of a body and an ancestor\n",
                     elements, nv * nv, pairs);
}

// The parts of results that are asked for, with their rows and columns.
std::string parts_text(const Model& model) {
  std::string text;
  for (const Output& output : outputs_of(model)) {
    if (!output.part) continue;
    const auto [rows, columns] = output.axes();
    text += fmt::format("  {}, {} x {}, {}\n", output.name, output.rows, output.columns,
                        ir::in_words(*output.part, rows, columns, model.tree));
  }
  return text.empty() ? "" : "\nparts of results:\n" + text;
}
std::string parts_json(const Model& model) {
  std::string text;
  for (const Output& output : outputs_of(model)) {
    if (!output.part) continue;
    const Labels labels = labels_of(model, output);
    text += fmt::format("{}\n    {}: {{\"rows\": {}, \"columns\": {}}}", text.empty() ? "" : ",", json_string(output.name),
                        json_array(labels.rows), json_array(labels.columns));
  }
  return text.empty() ? "" : fmt::format("  \"parts\": {{{}\n  }},\n", text);
}

std::string operations_json(const ir::Operations& o) {
  return fmt::format("\"add\": {}, \"multiply\": {}, \"divide\": {}, \"sincos\": {}", o.add, o.multiply, o.divide, o.sincos);
}

// One object per quantity, by name.
std::string quantities_json(const std::vector<OperationCost>& costs) {
  std::string text;
  for (const OperationCost& cost : costs) {
    std::string phases;
    for (const ir::Operations& phase : cost.phases)
      phases += fmt::format("{}{{{}}}", phases.empty() ? "" : ", ", operations_json(phase));
    text += fmt::format(
        "{}\n    {}: {{{}, \"reads_position\": {}, \"reads_velocity\": {}, \"reads_base_pose\": {}, \"phases\": [{}]}}",
        text.empty() ? "" : ",", json_string(cost.name), operations_json(cost.operations), cost.reads_position,
        cost.reads_velocity, cost.reads_base_pose, phases);
  }
  return text;
}

// One object per function.
std::string executed_json(const std::vector<std::pair<std::string, ir::Operations>>& functions) {
  std::string text;
  for (const auto& [name, operations] : functions)
    text += fmt::format("{}\n    {}: {{{}}}", text.empty() ? "" : ",", json_string(name), operations_json(operations));
  return text;
}

const std::string& name_of(ir::Form form) { return word_of(ir::form_words(), form); }
const std::string& name_of(ir::Solver solver) { return word_of(ir::solver_words(), solver); }

// Per function, the ways to compute it, the one chosen first.
std::string plan_json(const Lowered& lowered) {
  std::string text;
  for (const LoweredFunction& f : lowered.functions) {
    std::string ways;
    for (const Candidate& c : f.candidates)
      ways += fmt::format("{}{{\"form\": \"{}\", \"solver\": \"{}\", \"nanoseconds\": [{:.1f}]}}", ways.empty() ? "" : ", ",
                          name_of(c.form), name_of(c.solver), fmt::join(c.nanoseconds, ", "));
    text += fmt::format("{}\n    {}: [{}]", text.empty() ? "" : ",", json_string(f.name()), ways);
  }
  return text;
}

// Per function and width of registers, what the estimates are made of.
std::string features_json(const Model& model, const Lowered& lowered) {
  std::string text;
  for (const int lanes : backend::register_widths)
    for (const auto& [function, values] : features(model, lowered, lanes)) {
      std::string list;
      for (size_t i = 0; i < values.size(); ++i)
        list += fmt::format("{}\"{}\": {:.6g}", i == 0 ? "" : ", ", backend::feature_names[i], values[i]);
      text +=
          fmt::format("{}\n    {}: {{{}}}", text.empty() ? "" : ",", json_string(fmt::format("{} {}", function, lanes)), list);
    }
  return text;
}

// What was chosen of each function, and what the other ways would cost.
std::string plan_text(const Lowered& lowered) {
  std::string text = fmt::format("\nestimated time of a call on registers of {} doubles, the way that was chosen first:\n",
                                 fmt::join(backend::register_widths, ", "));
  for (const LoweredFunction& f : lowered.functions) {
    text += fmt::format("  {}\n", f.name());
    for (const Candidate& c : f.candidates) {
      std::string times;
      for (const double nanoseconds : c.nanoseconds) times += fmt::format("{:>10}", time_text(nanoseconds));
      text += fmt::format(
          "    {:<40}{}\n",
          (f.candidates.size() > 2 ? fmt::format("{} by {}", name_of(c.form), name_of(c.solver)) : name_of(c.form)) +
              (c.order == ir::Order::as_written ? "" : ", " + word_of(ir::order_words(), c.order)),
          times);
    }
    if (f.elsewhere)
      text += fmt::format("    {} where registers hold {}\n", name_of(f.elsewhere->plan.form),
                          fmt::join(f.elsewhere_lanes, " or "));
  }
  return text;
}

}  // namespace

std::string describe(const Model& model) {
  const Lowered lowered = lower(model);
  std::string text = summary(model) + coordinates(model.tree) + bodies(model.tree) + linkages(model.tree) + links(model.tree) +
                     frames(model.scene) + contacts_and_loops(model.scene) + sparsity(model.tree) + parts_text(model) + "\n";
  for (const std::string& line : left_out(model, lowered)) text += line + "\n";
  return text + plan_text(lowered);
}

std::string describe_json(const Model& model) {
  const ir::KinematicTree& tree = model.tree;
  std::vector<std::string> joints;
  for (const ir::Body& body : tree.bodies)
    if (body.independent()) joints.push_back(body.joint);
  const Lowered lowered = lower(model);
  const std::vector<OperationCost> before = too_large_to_compare(lowered) ? std::vector<OperationCost>{} : costs_before(model);
  return fmt::format(
      "{{\n  \"robot\": {},\n  \"name\": {},\n  \"base\": \"{}\",\n  \"nq\": {},\n  \"nv\": {},\n  \"joints\": {},\n"
      "  \"bodies\": {},\n{}{}  \"workspace_bytes\": {},\n  \"quantities\": {{{}\n  }},\n  \"without_scene\": {{{}\n  }},\n"
      "  \"executed\": {{{}\n  }},\n  \"plan\": {{{}\n  }},\n  \"estimates\": {{{}\n  }}\n}}\n",
      json_string(tree.robot), json_string(model.name), ir::row_of(tree.base_joint).word, tree.nq(), tree.nv(),
      json_array(joints), json_array(ir::names_of_links(tree)), constraints_json(model.scene), parts_json(model),
      workspace_bytes(model, lowered), quantities_json(operation_costs(lowered, tree)), quantities_json(before),
      executed_json(executed_operations(model, lowered)), plan_json(lowered), features_json(model, lowered));
}

}  // namespace dalembert
