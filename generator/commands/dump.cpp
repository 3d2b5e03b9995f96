#include "commands/dump.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "compile.hpp"
#include "costs.hpp"
#include "passes/levels.hpp"

namespace dalembert {
namespace {

// -0 and 0 print alike; all digits that matter.
std::string text_of(const Eigen::Vector3d& v) { return fmt::format("[{} {} {}]", v.x() + 0.0, v.y() + 0.0, v.z() + 0.0); }
std::string text_of(const Eigen::Matrix3d& m) {
  return text_of(Eigen::Vector3d(m.row(0))) + " " + text_of(Eigen::Vector3d(m.row(1))) + " " +
         text_of(Eigen::Vector3d(m.row(2)));
}

std::string text_of(const ir::Inertia& inertia) {
  return fmt::format("    mass {} kg, com {} m\n    inertia {} kg m^2\n", inertia.mass, text_of(inertia.com),
                     text_of(inertia.inertia));
}

std::string text_of(const ir::Moments& moments) {
  return fmt::format("    mass {}, first {}, half trace {}\n    second {}\n", moments.mass, text_of(moments.first),
                     moments.half_trace, text_of(moments.second));
}

std::string joint_name(const ir::KinematicTree& tree, int body) {
  return body < 0 ? "base" : tree.bodies[static_cast<size_t>(body)].joint;
}

std::string tree_text(const ir::KinematicTree& tree) {
  std::string text = fmt::format("{} base {}\n", ir::row_of(tree.base_joint).word, tree.base_link);
  if (tree.base_coordinates() > 0) text += text_of(tree.base);
  for (const ir::Body& b : tree.bodies) {
    text +=
        fmt::format("{} ({}, on {}) -> {}\n", b.joint, ir::word_of(b.turns(), b.slides()), joint_name(tree, b.parent), b.name);
    if (b.driven()) text += fmt::format("    mimic: {} * {} + {}\n", b.multiplier, joint_name(tree, b.driven_by), b.offset);
    text += fmt::format("    axis {}\n    rotation {}\n    translation {} m\n", text_of(b.axis),
                        text_of(Eigen::Matrix3d(b.placement.linear())), text_of(Eigen::Vector3d(b.placement.translation())));
    text += text_of(b.inertia);
  }
  return text;
}

std::string normal_tree_text(const ir::KinematicTree& tree, const ir::NormalTree& normal) {
  std::string text;
  if (tree.base_coordinates() > 0) text += "base\n" + text_of(normal.base);
  for (size_t k = 0; k < normal.bodies.size(); ++k) {
    const ir::NormalBody& b = normal.bodies[k];
    text += fmt::format("{} ({}, on {})\n    rotation {}\n    translation {} m\n", tree.bodies[k].joint,
                        ir::word_of(b.turning != 0, b.sliding != 0), joint_name(tree, b.parent), text_of(b.rotation),
                        text_of(b.translation));
    text += text_of(b.moments);
  }
  return text;
}

std::string input_text(const ir::KinematicTree& tree, const ir::Scene& scene, const ir::Algorithm& algorithm,
                       const ir::Input& input) {
  switch (input.kind) {
    case ir::InputKind::position: return fmt::format("q[{}]", input.index);
    case ir::InputKind::velocity: return fmt::format("v[{}]", input.index);
    case ir::InputKind::acceleration:
    case ir::InputKind::effort: return fmt::format("{}[{}]", input.kind == ir::InputKind::effort ? "tau" : "a", input.index);
    case ir::InputKind::gravity: return fmt::format("gravity[{}]", input.component);
    case ir::InputKind::wrench:
      return fmt::format("wrench {}[{}]", scene.wrenches.at(static_cast<size_t>(input.index)).link, input.component);
    case ir::InputKind::constraint:
      return fmt::format("{}[{}]", scene.constraints().at(static_cast<size_t>(input.index)).member, input.component);
    case ir::InputKind::element:
      return fmt::format("{}[{}]", algorithm.arrays[static_cast<size_t>(input.index)].name, input.component);
    case ir::InputKind::payload:
      return fmt::format("payload {}[{}]", scene.payloads.at(static_cast<size_t>(input.index)), input.component);
    default: return joint_name(tree, input.index);
  }
}

// What is done behind the elements, and with which arrays.
std::string kernels_text(const ir::Algorithm& algorithm) {
  std::string text;
  for (const ir::Kernel& kernel : algorithm.kernels) {
    const ir::KernelRow& row = ir::row_of(kernel.kind);
    text += fmt::format("kernel {}: {}\n", row.name, row.meaning);
    for (size_t o = 0; o < static_cast<size_t>(ir::Operand::count); ++o) {
      const auto operand = static_cast<ir::Operand>(o);
      if (const int array = kernel[operand]; array >= 0)
        text += fmt::format("  {} is {}: {}\n", ir::row_of(operand).name, algorithm.arrays[static_cast<size_t>(array)].name,
                            ir::row_of(operand).meaning);
    }
  }
  return text;
}

// One node a line: `%12 = multiply %3 %7  ; name`.
std::string program_text(const ir::KinematicTree& tree, const ir::Scene& scene, const ir::Algorithm& algorithm,
                         const ir::Program& program) {
  const std::vector<int> phases = passes::phases(algorithm);
  constexpr const char* op_names[] = {"constant", "input", "sine",     "cosine",   "sign",
                                      "negate",   "add",   "subtract", "multiply", "divide"};
  const std::vector<std::int32_t> uses = ir::uses(program.graph, program.roots());
  std::string text;
  for (ir::NodeId id = 0; id < program.graph.size(); ++id) {
    const ir::Node& n = program.graph[id];
    if (uses[static_cast<size_t>(id)] == 0) continue;
    text += fmt::format("%{} = {}", id, op_names[static_cast<size_t>(n.op)]);
    if (n.op == ir::Op::constant) text += fmt::format(" {}", n.value);
    if (n.op == ir::Op::input) text += " " + input_text(tree, scene, algorithm, n.input);
    if (n.a != ir::no_node) text += fmt::format(" %{}", n.a);
    if (n.b != ir::no_node) text += fmt::format(" %{}", n.b);
    if (n.op != ir::Op::constant && n.op != ir::Op::input)
      text += fmt::format("  ; phase {}, {}", n.tag.sweep < 0 ? 2 : phases[static_cast<size_t>(n.tag.sweep)],
                          joint_name(tree, n.tag.body));
    if (!program.names.empty() && !program.names[static_cast<size_t>(id)].empty())
      text += ", " + program.names[static_cast<size_t>(id)];
    text += "\n";
  }
  for (const ir::OutputElement& e : program.elements)
    text += fmt::format("{}({}, {}) = %{}\n", program.arrays[static_cast<size_t>(e.array)].name, e.row, e.column, e.node);
  return text + kernels_text(algorithm);
}

std::string plan_text(const ir::KinematicTree& tree, const ir::Plan& plan) {
  if (plan.form == ir::Form::straight) return "straight form: one straight line for the whole robot\n";
  std::string text = fmt::format("rolled form, {}, {} slots\n", plan.tasks ? "with a task graph" : "serial", plan.slots);
  for (const ir::Segment& s : plan.segments) {
    text += fmt::format("segment {}: {} lanes, {} steps, slots {} to {}\n", s.name, s.width, s.steps, s.first_slot,
                        s.first_slot + s.slots() - 1);
    for (size_t lane = 0; lane < s.bodies.size(); ++lane) {
      text += fmt::format("    lane {} on {}:", lane, joint_name(tree, s.parents[lane]));
      for (int body : s.bodies[lane]) text += " " + (body < 0 ? std::string("-") : joint_name(tree, body));
      text += "\n";
    }
  }
  return text;
}

std::string text_of(const ir::Operations& o) {
  return fmt::format("{} multiply, {} add, {} sin/cos, {} divide", o.multiply, o.add, o.sincos, o.divide);
}

std::string paragraph_text(int level, const ir::Paragraph& paragraph) {
  constexpr const char* directions[] = {"outwards", "inwards", "anywhere"};
  const ir::Operations per_slot = ir::count(paragraph.graph, ir::uses(paragraph.graph, paragraph.roots()));
  return fmt::format("    level {}, {}: values stored: {}, carried: {}; slots: {}, each {}\n      {}\n", level,
                     directions[static_cast<size_t>(paragraph.loop.direction)], paragraph.stores.size(),
                     paragraph.carried.size(), paragraph.loop.slots(), text_of(per_slot), fmt::join(paragraph.equations, ". "));
}

// Matrices that are filled together, and between which branches.
std::string blocks_text(const ir::Algorithm& algorithm, const ir::Plan& plan, const ir::PairBlocks& matrices) {
  std::string text;
  for (const ir::ElementSums& sums : matrices.sums) {
    const ir::Pairs& pairs = algorithm.pairs[static_cast<size_t>(sums.pairs)];
    text += fmt::format("{}{}: {}", text.empty() ? "" : ". ", algorithm.arrays[static_cast<size_t>(pairs.array)].name,
                        pairs.equation);
  }
  text += "\n";
  for (size_t s = 0; s < plan.segments.size(); ++s) {
    const ir::Segment& segment = plan.segments[s];
    const ir::SegmentBlocks& blocks = matrices.segments[s];
    if (blocks.empty()) continue;
    text += fmt::format("    blocks of {}, {}: with itself", segment.name,
                        segment.limb_after_limb ? "one branch after another"
                        : segment.width > 1     ? "branches in lanes"
                                                : "along rows");
    for (const ir::BlocksAbove& above : blocks.above) {
      if (above.steps == 0) continue;
      constexpr const char* where[] = {"each lane's own", "of one branch", "beside each other in one segment"};
      text += fmt::format("; with {} joint{} above, {}", above.steps, above.steps == 1 ? "" : "s",
                          where[static_cast<size_t>(above.where)]);
    }
    text += "\n";
  }
  return text;
}

std::string rolled_text(const ir::Algorithm& algorithm, const ir::Plan& plan, const ir::RolledProgram& rolled) {
  if (plan.form == ir::Form::straight) return "straight form: no loops\n";
  std::string text;
  for (size_t s = 0; s < rolled.segments.size(); ++s) {
    const ir::SegmentCode& code = rolled.segments[s];
    text += fmt::format("segment {}: {} constants per slot\n", plan.segments[s].name, code.columns.size());
    for (const ir::SegmentStage& stage : code.stages)
      for (const ir::Paragraph& paragraph : stage.paragraphs) text += paragraph_text(stage.level, paragraph);
  }
  for (const ir::PairBlocks& matrices : rolled.blocks) text += blocks_text(algorithm, plan, matrices);
  return text + kernels_text(algorithm);
}

std::string pass_table(const Model& model) {
  std::string text = fmt::format("\n{:<48}{:>10}{:>10}{:>10}{:>10}\n", "operations of all outputs after", "multiply", "add",
                                 "sin/cos", "divide");
  for (const PassCost& pass : pass_costs(model))
    text += fmt::format("{:<48}{:>10}{:>10}{:>10}{:>10}\n", pass.name, pass.operations.multiply, pass.operations.add,
                        pass.operations.sincos, pass.operations.divide);
  return text;
}

std::string stage_text(const Model& model, const Lowered& lowered, Stage stage) {
  switch (stage) {
    case Stage::tree: return tree_text(model.tree);
    case Stage::normal_tree: return normal_tree_text(model.tree, lowered.normal);
    default: break;
  }
  std::string text;
  const bool several = lowered.all_sections().size() > 1;
  for (const LoweredFunction& f : lowered.functions) {
    const ir::KinematicTree& tree = f.part ? f.part->tree : model.tree;
    for (const LoweredSection* s : f.all_sections()) {
      if (several) text += fmt::format("function {}\n", s->algorithm.section.name);
      if (stage == Stage::program) text += program_text(tree, model.scene, s->algorithm, s->program);
      if (stage == Stage::plan) text += plan_text(tree, s->plan);
      if (stage == Stage::rolled) text += rolled_text(s->algorithm, s->plan, s->rolled);
    }
  }
  return text;
}

}  // namespace

std::string dump(const Model& model, Stage stage) {
  Lowered lowered = lower(model, ir::Elements::kept);
  decide_tasks(model, lowered);
  return stage_text(model, lowered, stage) + pass_table(model);
}

}  // namespace dalembert
