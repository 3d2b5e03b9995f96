#include <algorithm>
#include <cassert>
#include <limits>

#include "ir/moved_links.hpp"
#include "passes/joints/quaternion.hpp"
#include "passes/unroll.hpp"

namespace dalembert::passes {

using ir::InputKind;
using ir::no_node;
using ir::NodeId;

namespace {
constexpr int nobody = -2, several = -1;  // whose a factor is
}  // namespace

bool Unroll::counts_elements() const {
  const bool adds = tree_.any_quaternion() && std::any_of(algorithm_.pairs.begin(), algorithm_.pairs.end(),
                                                          [](const ir::Pairs& p) { return p.between >= 0; });
  return options_.elements == ir::Elements::counted && !adds;
}

// Elements have their turn among the sweeps: who asks first for what sweeps of any order make, and who makes first what both
// need, decides whose operation it is. At their turn they are made up to a body that another one below it has met, for all that
// those above it hold is made.
bool Unroll::is_known(int filling, int body, int above) {
  if (column_is_ != Column::met || above == body) return false;
  std::vector<bool>& known = known_[static_cast<std::size_t>(filling)];
  const bool was = known[static_cast<std::size_t>(above)];
  known[static_cast<std::size_t>(above)] = true;
  return was;
}

// What the graph takes apart as it makes a product or a sum of it is claimed with it.
void Unroll::claim(NodeId factor, int body) {
  const ir::Graph& g = program_.graph;
  while (!g.is_constant(factor)) {
    int& owner = owner_[static_cast<std::size_t>(factor)];
    owner = owner == nobody || owner == body ? body : several;
    const ir::Node& n = g[factor];
    if (n.op == ir::Op::negate) factor = n.a;
    else if (n.op == ir::Op::add && (g.is_constant(n.a) || g.is_constant(n.b))) factor = g.is_constant(n.a) ? n.b : n.a;
    else return;
  }
}

void Unroll::claim_factors() {
  const int bodies = tree_.joints();
  const auto claim_three = [&](std::size_t place, int role, int from, int owner) {
    for (int i = from; i < from + 3; ++i)
      if (const NodeId node = values_[index(place, role, i)]; node != no_node) claim(node, owner);
  };
  const auto claim_one = [&](std::size_t place, const ir::Input& in, int owner) {
    if (const NodeId node = values_[index(place, in.index, in.component)]; node != no_node) claim(node, owner);
  };
  owner_.assign(static_cast<std::size_t>(program_.graph.size()), nobody);
  for (int body = -1; body < bodies + base_rows_; ++body) {  // behind the bodies the base's coordinates
    const std::size_t at = static_cast<std::size_t>(body + 1);
    const int owner = body >= 0 && body < bodies ? body : several;
    for (const ir::Pairs& p : algorithm_.pairs)
      for (const auto* terms : {&p.above, &p.below})
        for (const ir::PairTerm& t : *terms) {
          claim_three(at, t.lower, t.lower_from, owner);
          claim_three(at, t.upper, t.upper_from, several);
        }
    for (const ir::Projection& p : algorithm_.projections) {
      for (const ir::Input& in : p.inputs(InputKind::state)) claim_one(at, in, owner);
      for (const ir::Input& in : p.inputs(InputKind::carried)) claim_one(at, in, several);
    }
  }
  const ir::Graph& g = program_.graph;
  own_.resize(tree_.bodies.size()), readers_.resize(tree_.bodies.size());
  for (NodeId id = 0; id < g.size(); ++id) {
    if (const int owner = owner_[static_cast<std::size_t>(id)]; owner >= 0) own_[static_cast<std::size_t>(owner)].push_back(id);
    for (const NodeId operand : {g[id].a, g[id].b})
      if (const int owner = operand == no_node ? nobody : owner_[static_cast<std::size_t>(operand)]; owner >= 0)
        readers_[static_cast<std::size_t>(owner)].push_back(id);
  }
}

// Of what fills matrices, which has the tags behind those of the sweeps. Nodes that are not shared will be made once more.
long Unroll::operations_from(int first_tag) const {
  const ir::Graph& g = program_.graph;
  ir::Operations made;
  for (NodeId id = 0; id < g.size(); ++id)
    if (g[id].tag.sweep >= first_tag) made.count(g[id].op);
  return made.total();
}

// Behind all sweeps, for what one of them needs as well is to be found. Whose it is goes by whose turn came first.
//
// Column by column, all matrices of a column together. Where bodies have a coordinate together, elements are sums of several
// columns: those stay.
void Unroll::count_elements() {
  assert(algorithm_.pairs.size() + algorithm_.projections.size() <= 64);  // a bit each
  claim_factors();
  for (const ir::Pairs& p : algorithm_.pairs) filled_.push_back(p.array);
  for (const ir::Projection& p : algorithm_.projections) filled_.push_back(p.array);
  if (!options_.graph.share) program_.counted.nodes -= operations_from(static_cast<int>(algorithm_.sweeps.size()));
  std::map<int, int> bodies_of;
  for (const int coordinate : coordinates_) ++bodies_of[coordinate];
  each_alone_ = std::all_of(bodies_of.begin(), bodies_of.end(), [](const auto& bodies) { return bodies.second == 1; });
  for (int body = tree_.joints() - 1; body >= -1; --body) {
    const bool alone = body >= 0 && bodies_of[coordinates_[static_cast<std::size_t>(body)]] == 1;
    column_is_ = alone ? Column::counted : Column::none;
    needed_by_.resize(static_cast<std::size_t>(program_.graph.size()), 0);
    if (alone) program_.graph.open_scope(own_[static_cast<std::size_t>(body)], readers_[static_cast<std::size_t>(body)]);
    for (std::size_t p = 0; p < algorithm_.pairs.size(); ++p) {
      program_.graph.retag_from(turns_[p][place(body, -1)]);
      run_pairs(static_cast<int>(p), body);
    }
    program_.graph.retag_from(std::numeric_limits<NodeId>::max());
    for (std::size_t p = 0; p < algorithm_.projections.size(); ++p)
      if (body >= 0 || base_rows_ > 0) run_projection(static_cast<int>(p), body);
    if (alone) count_column(body);
  }
  column_is_ = Column::none;
  const auto each_array = [&](std::uint64_t bits, const auto& f) {
    for (std::size_t i = 0; i < filled_.size(); ++i)
      if (bits >> i & 1) f(filled_[i]);
  };
  for (const auto& [bits, operations] : counted_) {
    program_.counted.shares.push_back({{}, operations});
    each_array(bits, [&](int array) { program_.counted.shares.back().arrays.insert(array); });
  }
  for (std::size_t id = 0; id < needed_by_.size(); ++id)
    each_array(needed_by_[id], [&](int array) { program_.counted.factors[array].push_back(static_cast<NodeId>(id)); });
}

// Counts the nodes of a scope that no other column can have; the others are made once more without them.
void Unroll::count_column(int body) {
  ir::Graph& g = program_.graph;
  const auto at = [](NodeId id) { return static_cast<std::size_t>(id); };
  const NodeId first = static_cast<NodeId>(needed_by_.size()), end = g.size();
  needed_by_.resize(at(end), 0);
  const auto need = [&](int array, NodeId node) {
    const auto bit = std::find(filled_.begin(), filled_.end(), array) - filled_.begin();
    if (!g.is_constant(node)) needed_by_[at(node)] |= std::uint64_t{1} << bit;
  };
  for (const auto& [array, node] : column_) need(array, node);
  for (const std::tuple<int, int, int>& key : sums_)
    if (const auto element = elements_.find(key); element != elements_.end()) {
      need(std::get<0>(key), element->second);
      elements_.erase(element);
    }
  column_.clear(), sums_.clear();
  for (NodeId id = end - 1; id >= first; --id)
    for (const NodeId operand : {g[id].a, g[id].b})
      if (operand != no_node) needed_by_[at(operand)] |= needed_by_[at(id)];
  std::vector<bool> own(at(end - first), false);
  const auto is_own = [&](NodeId operand) {
    if (operand == no_node) return false;
    if (operand >= first) return static_cast<bool>(own[at(operand - first)]);
    return at(operand) < owner_.size() && owner_[at(operand)] == body;
  };
  std::uint64_t bits = 0;
  ir::Operations* sum = nullptr;  // of these
  std::vector<std::pair<NodeId, ir::Node>> others;
  std::vector<std::uint64_t> needed;
  for (NodeId id = first; id < end; ++id) {
    const ir::Node& n = g[id];
    const bool leaf = n.op == ir::Op::constant || n.op == ir::Op::input;
    own[at(id - first)] = !leaf && (!options_.graph.share || is_own(n.a) || is_own(n.b));
    if (own[at(id - first)]) {
      ++program_.counted.nodes;
      if (needed_by_[at(id)] == 0) continue;
      if (needed_by_[at(id)] != bits) sum = &counted_[bits = needed_by_[at(id)]];
      sum->count(n.op);
    } else {
      others.emplace_back(id, n);
      needed.push_back(needed_by_[at(id)]);
    }
  }
  g.close_scope();
  needed_by_.resize(at(first));
  std::map<NodeId, NodeId> again;
  for (std::size_t i = 0; i < others.size(); ++i) {
    const auto& [id, n] = others[i];
    const auto operand = [&](NodeId of) { return of < first ? of : again.at(of); };
    g.set_tag(tag_ = n.tag);
    again[id] = n.op == ir::Op::input ? g.input(n.input) : g.make(n.op, operand(n.a), operand(n.b), n.value);
    needed_by_.resize(at(g.size()), 0);
    needed_by_[at(again[id])] |= needed[i];
  }
}

}  // namespace dalembert::passes
