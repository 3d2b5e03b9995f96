#include "backend/batch_program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "backend/code_text.hpp"
#include "backend/emit_straight.hpp"
#include "backend/graph_printer.hpp"
#include "backend/literals.hpp"
#include "ir/implicit_joints.hpp"
#include "ir/run_time_inputs.hpp"

namespace dalembert::backend {
namespace {

using ir::no_node;
using ir::NodeId;
using ir::Op;

// Of a part. Measured: what a register file cannot hold is then still near, and the text of a part stays in first-level caches.
constexpr long most_operations = 1300;

size_t at(NodeId id) { return static_cast<size_t>(id); }

// A broadcast of what is a number, and no register.
const std::string broadcast_begin = "dalembert::broadcast<dalembert::batch_width<Scalar>, Scalar>(";

}  // namespace

std::vector<int> BatchArray::by_rows() const {
  std::vector<int> places;
  for (int row = 0; row < array.rows; ++row)
    for (int column = 0; column < array.columns; ++column)
      places.push_back(by_columns[static_cast<size_t>(row + array.rows * column)]);
  return places;
}

int BatchProgram::given_place(const ir::Input& input) const {
  int place = 0;
  for (const ir::RunTimeInput& own : given_) {
    if (own.kind == input.kind && own.index == input.index) return place + own.number_of(input.component);
    place += own.size();
  }
  throw std::logic_error("no run-time input of a batch");
}

int BatchProgram::given_count() const {
  int count = 0;
  for (const ir::RunTimeInput& own : given_) count += own.size();
  return count;
}

BatchProgram::BatchProgram(const CodeInput& code, const CodeInput* line, bool all_given)
    : by_calls_(!line), code_(by_calls_ ? code : *line), graph_(code_.program.graph), given_(ir::run_time_inputs(code.scene)) {
  if (by_calls_) {
    place_all();
    return;
  }
  place_elements();
  find_angles();
  cut();
  if (!all_given) std::erase_if(given_, [this](const ir::RunTimeInput& input) { return !reads(input); });
  const ir::InputsRead read = ir::inputs_read(code_.program, uses_);
  reads_positions_ = !read.positions.empty();
  reads_velocities_ = !read.velocities.empty();
  reads_input_ = read.input;
}

bool BatchProgram::reads(const ir::RunTimeInput& input) const {
  for (NodeId id = 0; id < graph_.size(); ++id) {
    const ir::Node& n = graph_[id];
    if (uses_[at(id)] > 0 && n.op == Op::input && n.input.kind == input.kind && n.input.index == input.index) return true;
  }
  return false;
}

void BatchProgram::place_elements() {
  places_.resize(at(graph_.size()));
  const std::optional<ir::Guard>& guard = code_.algorithm.guard;
  std::vector<NodeId> roots;
  for (size_t index = 0; index < code_.program.arrays.size(); ++index) {
    const ir::OutputArray& a = code_.program.arrays[index];
    const bool checked = guard && (static_cast<int>(index) == guard->pivots || static_cast<int>(index) == guard->diagonal);
    if (a.internal && !checked) continue;
    std::map<std::pair<int, int>, NodeId> nodes;
    for (const ir::OutputElement& e : code_.program.elements)
      if (e.array == static_cast<int>(index)) nodes[{e.row, e.column}] = e.node;
    const auto node = [&](int row, int column) {
      const auto found = nodes.find({row, column});
      return found == nodes.end() ? no_node : found->second;
    };
    BatchArray own{a, elements_, {}, a.rows == a.columns && a.rows > 1, {}, false};
    for (const auto& [place, id] : nodes) own.symmetric = own.symmetric && node(place.second, place.first) == id;
    own.by_columns.assign(static_cast<size_t>(a.rows) * static_cast<size_t>(a.columns), -1);
    // Vectors are whole.
    for (int row = 0; row < a.rows && a.columns == 1; ++row) nodes.try_emplace({row, 0}, no_node);
    for (const auto& [place, id] : nodes) {
      const auto [row, column] = place;
      if (own.symmetric && column > row) continue;
      own.by_columns[static_cast<size_t>(element_index(a, row, column))] = elements_;
      if (own.symmetric) own.by_columns[static_cast<size_t>(element_index(a, column, row))] = elements_;
      own.packed.emplace_back(row, column);
      if (id == no_node) {
        zeros_.push_back(elements_++);
        continue;
      }
      places_[at(id)].push_back(elements_++);
      roots.push_back(id);
    }
    // Pivots before the diagonal.
    own.cleared =
        guard && std::find(guard->arrays.begin(), guard->arrays.end(), static_cast<int>(index)) != guard->arrays.end();
    if (!a.internal) results_.push_back(own);
    if (checked) checked_.insert(static_cast<int>(index) == guard->pivots ? checked_.begin() : checked_.end(), own);
  }
  uses_ = ir::uses(graph_, roots);
}

void BatchProgram::place_all() {
  for (const ir::OutputArray& a : code_.program.arrays) {
    if (a.internal) continue;
    BatchArray own{a, elements_, {}, false, {}, false};
    own.by_columns.resize(static_cast<size_t>(a.rows) * static_cast<size_t>(a.columns));
    for (int row = 0; row < a.rows; ++row)
      for (int column = 0; column < a.columns; ++column) {
        own.packed.emplace_back(row, column);
        own.by_columns[static_cast<size_t>(element_index(a, row, column))] = elements_++;
      }
    results_.push_back(std::move(own));
  }
  reads_positions_ = reads_velocities_ = true;
  reads_input_ = *function_of(code_).input() != 0;
}

void BatchProgram::find_angles() {
  for (NodeId id = 0; id < graph_.size(); ++id)
    if (uses_[at(id)] > 0 && (graph_[id].op == Op::sine || graph_[id].op == Op::cosine))
      angle_index_.try_emplace(graph_[id].a, static_cast<int>(angle_index_.size()));
}

// What any part has without computing it.
bool BatchProgram::is_free(NodeId id) const {
  const Op op = graph_[id].op;
  return op == Op::constant || op == Op::input || op == Op::sine || op == Op::cosine;
}

void BatchProgram::cut() {
  // What only angles need is computed with them.
  std::vector<NodeId> roots;
  for (NodeId id = 0; id < graph_.size(); ++id)
    if (!places_[at(id)].empty()) roots.push_back(id);
  std::vector<bool> needed(at(graph_.size()), false);
  for (const NodeId root : roots) needed[at(root)] = true;
  for (NodeId id = graph_.size() - 1; id >= 0; --id) {
    if (!needed[at(id)] || is_free(id)) continue;
    for (const NodeId operand : {graph_[id].a, graph_[id].b})
      if (operand != no_node) needed[at(operand)] = true;
  }
  const auto counts = [&](NodeId id) { return needed[at(id)] && !is_free(id) && graph_[id].op != Op::negate; };
  for (NodeId id = 0; id < graph_.size(); ++id) operations_ += counts(id);
  parts_ = std::max(1, static_cast<int>((operations_ + most_operations - 1) / most_operations));

  part_of_.assign(at(graph_.size()), -1);
  std::vector<int> last(at(graph_.size()), -1);  // part that reads it
  long before = 0;
  for (NodeId id = 0; id < graph_.size(); ++id) {
    if (!needed[at(id)]) continue;
    const int part = std::min(parts_ - 1, static_cast<int>(before * parts_ / std::max(1L, operations_)));
    before += counts(id);
    part_of_[at(id)] = part;
    if (is_free(id)) continue;
    for (const NodeId operand : {graph_[id].a, graph_[id].b})
      if (operand != no_node) last[at(operand)] = part;
  }
  // A slot is free for what a later part leaves than the last that reads it.
  slot_of_.assign(at(graph_.size()), -1);
  std::vector<int> free_from;  // per slot
  for (NodeId id = 0; id < graph_.size(); ++id) {
    if (!needed[at(id)] || is_free(id) || !places_[at(id)].empty() || last[at(id)] <= part_of_[at(id)]) continue;
    size_t slot = 0;
    while (slot < free_from.size() && free_from[slot] > part_of_[at(id)]) ++slot;
    if (slot == free_from.size()) free_from.push_back(0);
    free_from[slot] = last[at(id)] + 1;
    slot_of_[at(id)] = static_cast<int>(slot);
  }
  kept_ = static_cast<int>(free_from.size());
}

std::string BatchProgram::input_text(const ir::Input& input) const {
  switch (input.kind) {
    case ir::InputKind::position: return fmt::format("block.q[{}]", input.index);
    case ir::InputKind::velocity: return fmt::format("block.v[{}]", input.index);
    case ir::InputKind::acceleration:
    case ir::InputKind::effort: return fmt::format("block.input[{}]", input.index);
    case ir::InputKind::state: return fmt::format("block.scratch[{}]", input.index);
    case ir::InputKind::received: return fmt::format("block.values[{}]", input.index);
    case ir::InputKind::table: return fmt::format("block.{}[{}]", input.component == 0 ? "sine" : "cosine", input.index);
    case ir::InputKind::implicit:
      return fmt::format("block.given[{}]", given_count() + ir::implicit_numbers * input.index + input.component);
    default: return given_text(input);
  }
}

std::string BatchProgram::given_text(const ir::Input& input) const {
  const std::string number = fmt::format("block.given[{}]", given_place(input));
  if (input.kind != ir::InputKind::constraint || input.component == ir::contact_active) return number;
  const int active = given_place({input.kind, input.index, ir::contact_active});
  return fmt::format("(block.given[{}] > 0 ? {} : {})", active, number, literal(0, code_.scene.scalar));  // as single calls do
}

std::string BatchProgram::angle_statements() const {
  std::vector<Sink> sinks;
  for (const auto& [node, i] : angle_index_) {
    const bool constant = graph_.is_constant(node);
    sinks.push_back({node, fmt::format("block.angle[{}] = {}", i, constant ? broadcast_begin : ""), constant ? ");" : ";"});
  }
  PrintStyle style;
  style.type = "V";
  style.scalar = code_.scene.scalar;
  style.input = [this](const ir::Input& input) { return input_text(input); };
  style.broadcast = [](const std::string& number) { return broadcast_begin + number + ")"; };
  std::string text = print(graph_, sinks, style);
  for (const int place : zeros_) text += fmt::format("  block.values[{}] = V{{}};\n", place);
  return text;
}

std::string BatchProgram::part_statements(int part) const {
  ir::Graph graph(ir::Graph::Options{false, true});
  ir::Copy copy(graph_, graph);
  std::vector<std::string> names;
  std::vector<Sink> sinks;
  const auto known = [&](NodeId id) -> NodeId {
    const ir::Node& n = graph_[id];
    if (n.op == Op::sine || n.op == Op::cosine)
      return graph.input({ir::InputKind::table, angle_index_.at(n.a), n.op == Op::sine ? 0 : 1});
    if (is_free(id) || part_of_[at(id)] == part) return no_node;
    if (!places_[at(id)].empty()) return graph.input({ir::InputKind::received, places_[at(id)].front()});
    return graph.input({ir::InputKind::state, slot_of_[at(id)]});
  };
  const auto input = [&](const ir::Input& in) { return graph.input(in); };
  for (NodeId id = 0; id < graph_.size(); ++id) {
    if (part_of_[at(id)] != part) continue;
    const bool stored = !places_[at(id)].empty() || slot_of_[at(id)] >= 0;
    if (is_free(id) && !stored) continue;
    graph.set_tag(graph_[id].tag);
    const NodeId made = copy.node_until(id, known, input);
    if (!code_.program.names.empty() && graph_[id].op != Op::constant) {
      names.resize(at(graph.size()));
      names[at(made)] = code_.program.names[at(id)];
    }
    const bool constant = graph_.is_constant(id);
    const auto sink = [&](const std::string& to) {
      sinks.push_back({made, to + " = " + (constant ? broadcast_begin : ""), constant ? ");" : ";"});
    };
    for (const int place : places_[at(id)]) sink(fmt::format("block.values[{}]", place));
    if (slot_of_[at(id)] >= 0) sink(fmt::format("block.scratch[{}]", slot_of_[at(id)]));
  }
  names.resize(at(graph.size()));
  PrintStyle style;
  style.type = "V";
  style.scalar = code_.scene.scalar;
  style.flat_sums = true;
  style.input = [this](const ir::Input& in) { return input_text(in); };
  style.input_name = [this](const ir::Input& in) {
    const bool is_chosen = in.kind == ir::InputKind::constraint && in.component != ir::contact_active;
    return is_chosen ? fmt::format("given_{}", given_place(in)) : input_text(in);
  };
  style.name = [&](NodeId id) { return names[at(id)]; };
  style.heading = [this](const ir::Tag& tag) { return straight_heading(code_, tag); };
  style.broadcast = [](const std::string& number) { return broadcast_begin + number + ")"; };
  return print(graph, sinks, style);
}

}  // namespace dalembert::backend
