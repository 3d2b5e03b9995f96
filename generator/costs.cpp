#include "costs.hpp"

#include <algorithm>
#include <set>

#include "frontend/scene_check.hpp"
#include "ir/embedding_cost.hpp"
#include "passes/build_tree.hpp"
#include "passes/levels.hpp"

namespace dalembert {
namespace {

std::vector<int> missing(const std::set<int>& read, int size) {
  std::vector<int> rest;
  for (int i = 0; i < size; ++i)
    if (!read.contains(i)) rest.push_back(i);
  return rest;
}

// The arrays that some are made of, themselves among them, and the kernels that make them. What says whether M can be solved
// with counts.
struct Making {
  std::set<int> arrays;
  std::vector<ir::Kernel> kernels;
};
Making making(const ir::Algorithm& algorithm, const std::set<int>& arrays) {
  Making m{arrays, {}};
  if (const std::optional<ir::Guard>& guard = algorithm.guard;
      guard && std::any_of(guard->arrays.begin(), guard->arrays.end(), [&](int array) { return arrays.contains(array); })) {
    m.arrays.insert({guard->pivots, guard->diagonal, guard->factor, guard->gain, guard->joint});  // some may be none
  }
  for (const ir::Projection& p : algorithm.projections)
    if (!p.by_rows.empty() && arrays.contains(p.array)) m.arrays.insert({p.bodies, p.joints});
  for (auto kernel = algorithm.kernels.rbegin(); kernel != algorithm.kernels.rend(); ++kernel) {
    const std::vector<int> filled = kernel->filled();
    if (std::none_of(filled.begin(), filled.end(), [&](int array) { return m.arrays.contains(array); })) continue;
    for (const int array : kernel->read()) m.arrays.insert(array);
    m.kernels.push_back(*kernel);
  }
  return m;
}

// What a section's arrays cost: each as much work as it needs nodes, for outputs may be thousands.
class Counting {
 public:
  Counting(const LoweredSection& section, const ir::KinematicTree& tree)
      : section_(section), tree_(tree), phases_(passes::phases(section.algorithm)), roots_(program().arrays.size()) {
    for (const ir::OutputElement& e : program().elements) roots_[static_cast<size_t>(e.array)].push_back(e.node);
    for (const auto& [array, factors] : program().counted.factors)
      roots_[static_cast<size_t>(array)].insert(roots_[static_cast<size_t>(array)].end(), factors.begin(), factors.end());
    met_.resize(static_cast<size_t>(program().graph.size()), false);
  }

  const LoweredSection& section() const { return section_; }

  // reads_input: set to whether it reads what the function takes besides q and v.
  OperationCost cost_of(const std::string& name, const Making& made, bool* reads_input = nullptr) {
    OperationCost cost;
    cost.name = name;
    ir::InputsRead read;
    read.base_positions = program().base_positions;
    std::set<ir::NodeId> angles;
    std::array<std::set<ir::NodeId>, 3> angles_of_phases;
    for (const ir::NodeId id : needed(made)) {
      const ir::Node& n = program().graph[id];
      const auto phase = static_cast<size_t>(phase_of(n.tag)) - 1;
      cost.operations.count(n.op);
      cost.phases[phase].count(n.op);
      if (n.op == ir::Op::sine || n.op == ir::Op::cosine) angles.insert(n.a), angles_of_phases[phase].insert(n.a);
      if (n.op == ir::Op::input) read.add(n.input);
    }
    cost.operations.sincos = static_cast<long>(angles.size());
    for (size_t i = 0; i < 3; ++i) cost.phases[i].sincos = static_cast<long>(angles_of_phases[i].size());
    ir::Operations elements = ir::counted(program(), made.arrays);
    for (const ir::Kernel& kernel : made.kernels) elements += ir::operations_of(kernel, tree_, false);
    cost.operations += elements;
    cost.phases[2] += elements;
    cost.reads_base_pose = read.base_pose();
    cost.reads_base_position = read.base_position();
    cost.reads_position = read.joint_positions();
    cost.reads_velocity = !read.velocities.empty();
    cost.positions_not_read = missing(read.positions, tree_.nq());
    cost.velocities_not_read = missing(read.velocities, tree_.nv());
    if (reads_input) *reads_input = read.input;
    return cost;
  }

 private:
  const ir::Program& program() const { return section_.program; }
  // What belongs to no sweep is a payload's moments.
  int phase_of(const ir::Tag& tag) const { return tag.sweep < 0 ? 2 : phases_[static_cast<size_t>(tag.sweep)]; }

  std::vector<ir::NodeId> needed(const Making& made) {
    std::vector<ir::NodeId> nodes;
    const auto add = [&](ir::NodeId id) {
      if (id == ir::no_node || met_[static_cast<size_t>(id)]) return;
      met_[static_cast<size_t>(id)] = true;
      nodes.push_back(id);
    };
    for (const int array : made.arrays)
      if (array >= 0 && array < static_cast<int>(roots_.size()))
        for (const ir::NodeId id : roots_[static_cast<size_t>(array)]) add(id);
    for (size_t i = 0; i < nodes.size(); ++i) add(program().graph[nodes[i]].a), add(program().graph[nodes[i]].b);
    for (const ir::NodeId id : nodes) met_[static_cast<size_t>(id)] = false;
    return nodes;
  }

  const LoweredSection& section_;
  const ir::KinematicTree& tree_;
  std::vector<int> phases_;
  std::vector<std::vector<ir::NodeId>> roots_;  // per array
  std::vector<bool> met_;                       // per node; false between calls
};

// Everything that it makes.
Making all_of(const ir::Algorithm& algorithm) {
  Making m{{}, algorithm.kernels};
  for (size_t a = 0; a < algorithm.arrays.size(); ++a) m.arrays.insert(static_cast<int>(a));
  return m;
}

// -1: it has none of that name.
int array_called(const std::string& name, const ir::Algorithm& algorithm) {
  for (size_t a = 0; a < algorithm.arrays.size(); ++a)
    if (algorithm.arrays[a].name == name) return static_cast<int>(a);
  return -1;
}

// What two of them cost and read, one after the other.
OperationCost sum(OperationCost a, const OperationCost& b) {
  a.operations += b.operations;
  for (size_t i = 0; i < a.phases.size(); ++i) a.phases[i] += b.phases[i];
  a.reads_position = a.reads_position || b.reads_position;
  a.reads_velocity = a.reads_velocity || b.reads_velocity;
  a.reads_base_pose = a.reads_base_pose || b.reads_base_pose;
  a.reads_base_position = a.reads_base_position || b.reads_base_position;
  const auto in_both = [](std::vector<int>& list, const std::vector<int>& other) {
    std::erase_if(list, [&](int i) { return std::find(other.begin(), other.end(), i) == other.end(); });
  };
  in_both(a.positions_not_read, b.positions_not_read);
  in_both(a.velocities_not_read, b.velocities_not_read);
  return a;
}

// The model without its scene, but for the outputs: the default ones and `model`'s own.
Model whole_robot(const Model& model) {
  Model whole;
  whole.description = model.description;
  whole.name = model.name;
  whole.options = model.options;
  whole.scene.base = model.tree.base_coordinates() > 0 ? ir::Base::floating : frontend::default_base(model.description);
  for (ir::Quantity quantity : model.scene.outputs)
    if (std::find(whole.scene.outputs.begin(), whole.scene.outputs.end(), quantity) == whole.scene.outputs.end())
      whole.scene.outputs.push_back(quantity);
  whole.scene.functions = model.scene.functions;
  whole.scene.jacobians = model.scene.jacobians;
  whole.scene.frames = model.scene.frames;
  for (ir::NamedFunction& function : whole.scene.functions) {
    function.parts.clear();
    for (ir::LinkOutput& output : function.of_links) output.part.reset();
  }
  for (ir::LinkOutput& output : whole.scene.frames) output.part.reset();
  whole.scene.placed = model.scene.placed;
  whole.scene.contacts = model.scene.contacts;
  whole.scene.loops = model.scene.loops;
  Diagnostics warnings;
  whole.tree = passes::build_tree(whole.description, whole.scene, warnings);
  return whole;
}

Model as_written(Model model) {
  model.options.fold = model.options.share = model.options.move_parameters = false;
  return model;
}

}  // namespace

namespace {

// Of a function with embedded loops, what some of its arrays cost.
OperationCost embedded_cost(const std::string& name, const LoweredSection& f, const LoweredSection& opened,
                            const std::set<int>& arrays, const ir::KinematicTree& tree, const ir::KinematicTree& opened_tree) {
  const Making made = making(f.algorithm, arrays);
  const ir::Embedding& e = *f.algorithm.embedding;
  std::set<int> from;
  ir::Operations own;
  for (const ir::Projected& p : e.projected) {
    if (!made.arrays.contains(p.to)) continue;
    own += ir::operations_of(p, tree);
    for (const std::string& array : {p.from, p.more})
      if (const int at = array_called(array, opened.algorithm); at >= 0) from.insert(at);
  }
  OperationCost cost = Counting(opened, opened_tree).cost_of(name, making(opened.algorithm, from));
  for (const ir::Kernel& kernel : made.kernels) own += ir::operations_of(kernel, tree, false);
  own += ir::operations_of_linkages(tree, e.rates >= 0 && (cost.reads_velocity || e.accelerated));
  cost.operations += own;
  cost.phases[2] += own;
  cost.reads_position = true;
  cost.reads_velocity = cost.reads_velocity || (e.rates >= 0 && e.accelerated);
  // Of followers nobody asks whether they are read.
  cost.positions_not_read.clear();
  cost.velocities_not_read.clear();
  return cost;
}

std::vector<OperationCost> embedded_costs(const Lowered& lowered, const ir::KinematicTree& tree) {
  std::vector<OperationCost> costs(1);
  for (const LoweredFunction& function : lowered.functions) {
    const LoweredSection &f = function.first(), &opened = function.opened.front().first();
    const auto cost = [&](const std::string& name, const std::set<int>& arrays) {
      return embedded_cost(name, f, opened, arrays, tree, lowered.opened->tree);
    };
    const OperationCost all = cost("all", all_of(f.algorithm).arrays);
    costs.front() = &function == &lowered.functions.front() ? all : sum(costs.front(), all);
    for (size_t a = 0; a < f.algorithm.arrays.size(); ++a)
      if (!f.algorithm.arrays[a].internal) costs.push_back(cost(f.algorithm.arrays[a].name, {static_cast<int>(a)}));
  }
  return costs;
}

}  // namespace

namespace {

// Of an array, with what is made for it in the sections before the one that fills it.
OperationCost cost_of(int array, std::vector<Counting>& sections) {
  const std::string& name = sections.front().section().program.arrays[static_cast<size_t>(array)].name;
  std::set<int> wanted{array};
  OperationCost cost;
  for (size_t s = sections.size(); s-- > 0;) {
    const ir::Algorithm& algorithm = sections[s].section().algorithm;
    const Making made = making(algorithm, wanted);
    bool reads_input = false;
    const OperationCost own = sections[s].cost_of(name, made, &reads_input);
    cost = s + 1 == sections.size() ? own : sum(own, cost);
    wanted.insert(made.arrays.begin(), made.arrays.end());
    if (reads_input) wanted.insert(algorithm.section.accelerations);
  }
  return cost;
}

}  // namespace

std::vector<OperationCost> operation_costs(const Lowered& lowered, const ir::KinematicTree& tree) {
  if (lowered.opened) return embedded_costs(lowered, tree);
  std::vector<OperationCost> costs;
  for (const LoweredSection* section : lowered.all_sections()) {
    const OperationCost all = Counting(*section, tree).cost_of("all", all_of(section->algorithm));
    if (costs.empty()) costs.push_back(all);
    else costs.front() = sum(costs.front(), all);
  }
  for (const LoweredFunction& f : lowered.functions) {
    const std::vector<ir::OutputArray>& arrays = f.first().program.arrays;
    std::vector<Counting> sections;
    for (const LoweredSection& section : f.sections) sections.emplace_back(section, tree);
    for (size_t a = 0; a < arrays.size(); ++a)
      if (!arrays[a].internal) costs.push_back(cost_of(static_cast<int>(a), sections));
  }
  return costs;
}

std::vector<OperationCost> operation_costs(const Model& model) { return operation_costs(lower_to_programs(model), model.tree); }

std::vector<OperationCost> costs_before(const Model& model) {
  try {
    return operation_costs(as_written(whole_robot(model)));
  } catch (const InputError&) {
    return {};
  }
}

bool too_large_to_compare(const Lowered& lowered) {
  long nodes = 0;
  for (const LoweredSection* section : lowered.all_sections())
    nodes += section->program.graph.size() + section->program.counted.nodes;
  return nodes > 500'000;
}

std::vector<PassCost> pass_costs(const Model& model) {
  std::vector<PassCost> list;
  const auto add = [&](const std::string& name, const Model& m) {
    list.push_back({name, operation_costs(m).front().operations});
  };
  if (const std::vector<OperationCost> before = costs_before(model); !before.empty())
    list.push_back({"the whole URDF, as the equations are written", before.front().operations});
  Model step = as_written(model);
  add("+ scene", step);
  if (model.options.fold) step.options.fold = true, add("+ fold", step);
  if (model.options.share) step.options.share = true, add("+ share", step);
  if (model.options.move_parameters) step.options.move_parameters = true, add("+ move_parameters", step);
  return list;
}

}  // namespace dalembert
