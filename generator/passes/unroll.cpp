#include "passes/unroll.hpp"

#include <algorithm>
#include <limits>
#include <set>

#include "ir/identifier.hpp"
#include "ir/moved_links.hpp"
#include "passes/joints.hpp"
#include "passes/joints/quaternion.hpp"
#include "passes/levels.hpp"
#include "passes/parameters.hpp"
#include "passes/payload.hpp"

namespace dalembert::passes {

using ir::Direction;
using ir::InputKind;
using ir::no_node;
using ir::NodeId;

Unroll::Unroll(const ir::Algorithm& algorithm, const ir::KinematicTree& tree, const ir::NormalTree& normal,
               const ir::Scene& scene, const UnrollOptions& options)
    : algorithm_(algorithm),
      tree_(tree),
      normal_(normal),
      scene_(scene),
      options_(options),
      live_(passes::live(algorithm, tree.base_coordinates())),
      coordinates_(tree.coordinates()),
      positions_(tree.positions()),
      links_(ir::numbers_of_links(tree)),
      base_rows_(tree.base_coordinates()),
      implicit_(options.implicit ? ir::implicit_joints(tree) : std::vector<ir::ImplicitJoint>()),
      producer_(algorithm.roles.size(), -1),
      base_producer_(algorithm.roles.size(), -1),
      towards_(tree.bodies.size(), -1),
      at_its_joint_(tree.bodies.size(), false),
      values_((tree.bodies.size() + 7) * static_cast<std::size_t>(live_.offset.back()), no_node),
      handed_((tree.bodies.size() + 1) * static_cast<std::size_t>(live_.offset.back()), no_node),
      done_(algorithm.sweeps.size(), std::vector<bool>(tree.bodies.size() + 1, false)),
      known_(algorithm.pairs.size() + algorithm.projections.size(), std::vector<bool>(tree.bodies.size(), false)),
      turns_(algorithm.pairs.size(), std::vector<NodeId>(tree.bodies.size() + 1, std::numeric_limits<NodeId>::max())) {
  program_.graph = ir::Graph(options.graph);
  program_.base_positions = tree.base_positions();
  program_.arrays = algorithm.arrays;
  if (!counts_elements()) reserve_elements();
  for (std::size_t s = 0; s < algorithm.sweeps.size(); ++s)
    for (const ir::Value& v : algorithm.sweeps[s].stores)
      (algorithm.sweeps[s].over.is_base() ? base_producer_ : producer_)[static_cast<std::size_t>(v.role)] = static_cast<int>(s);
  for (int body = -1; body < tree.joints(); ++body)
    payload_.push_back(payload_parameters(program_.graph, tree, normal, scene, body));
  for (int body = 0; body < tree.joints(); ++body)
    payload_[place(body, -1)].merge(
        quaternion_parameters(program_.graph, tree, normal, positions_, coordinates_, scene.rates_zero, body));
  add_implicit_joints();
  for (const int body : options_.references) refer_to(body);
  find_companions();
  if (counts_elements()) column_is_ = Column::met;
  for (const Loop& loop : loops()) run_loop(loop);
  if (counts_elements()) count_elements();
  collect_results();
}

// They are most of a long chain's nodes.
void Unroll::reserve_elements() {
  std::size_t pairs = 0;
  std::vector<std::size_t> depth(tree_.bodies.size(), 1);
  for (std::size_t k = 0; k < tree_.bodies.size(); ++k) {
    if (tree_.bodies[k].parent >= 0) depth[k] += depth[static_cast<std::size_t>(tree_.bodies[k].parent)];
    pairs += depth[k];
  }
  std::size_t per_pair = 0;
  for (const ir::Pairs& p : algorithm_.pairs) per_pair += 6 * (p.above.size() + p.below.size());
  program_.graph.reserve(pairs * per_pair);
}

// To the armature, the armature having been zero or not.
void Unroll::add_implicit_joints() {
  for (std::size_t i = 0; i < implicit_.size(); ++i)
    for (const int parameter : {armature_p, axis_inertia_p})
      payload_[place(implicit_[i].body, -1)][parameter] =
          program_.graph.input({InputKind::implicit, static_cast<int>(i), ir::implicit_inertia});
}

// What acts on a joint, less how much harder its spring pulls behind the step than before it, the joint moving on as it does.
NodeId Unroll::implicit_effort(NodeId effort, int body) {
  for (std::size_t i = 0; i < implicit_.size(); ++i) {
    const ir::ImplicitJoint& joint = implicit_[i];
    if (joint.body != body || joint.stiffness == 0) continue;
    const NodeId pull = program_.graph.input({InputKind::implicit, static_cast<int>(i), ir::implicit_force});
    const NodeId rate = program_.graph.input({InputKind::velocity, joint.coordinate});
    return program_.graph.subtract(effort, program_.graph.multiply(pull, rate));
  }
  return effort;
}

// Directional sweeps in their order. Pairs follow, body by body, the inwards sweep that their factors wait for: an element is
// computed when its factors are there and not after everything else. Whatever runs anywhere runs where it is asked for first,
// but for companions.
std::vector<Unroll::Loop> Unroll::loops() const {
  std::vector<Loop> all;
  std::vector<int> loop_of(algorithm_.sweeps.size(), -1);
  for (std::size_t s = 0; s < algorithm_.sweeps.size(); ++s) {
    const Direction d = algorithm_.sweeps[s].direction;
    if (d == Direction::anywhere) continue;
    loop_of[s] = static_cast<int>(all.size());
    all.push_back({{static_cast<int>(s)}, {}});
  }
  std::vector<int> known(algorithm_.roles.size(), -2);
  Loop rest;
  const bool projections = !algorithm_.projections.empty();
  for (std::size_t p = 0; p < algorithm_.pairs.size(); ++p) {
    int last = -1;
    for (const auto* terms : {&algorithm_.pairs[p].above, &algorithm_.pairs[p].below})
      for (const ir::PairTerm& t : *terms) last = std::max({last, last_inwards(t.lower, known), last_inwards(t.upper, known)});
    (last < 0 ? rest : all[static_cast<std::size_t>(loop_of[static_cast<std::size_t>(last)])])
        .pairs.push_back(static_cast<int>(p));
  }
  if (!rest.pairs.empty() || projections) all.push_back(rest);
  return joined(std::move(all));
}

// Sums inwards go body by body with those of the same level that divide: while they wait there is something to do.
std::vector<Unroll::Loop> Unroll::joined(std::vector<Loop> loops) const {
  const std::vector<int> level = levels(algorithm_);
  const auto level_of = [&](const Loop& loop) {
    return loop.sweeps.empty() ? std::numeric_limits<int>::max() : level[static_cast<std::size_t>(loop.sweeps.front())];
  };
  const auto inwards = [&](const Loop& loop) {
    return !loop.sweeps.empty() &&
           algorithm_.sweeps[static_cast<std::size_t>(loop.sweeps.front())].direction == Direction::inwards;
  };
  const auto divides = [&](const Loop& loop) {
    return std::any_of(loop.sweeps.begin(), loop.sweeps.end(), [&](int s) {
      const ir::Graph& g = algorithm_.sweeps[static_cast<std::size_t>(s)].graph;
      for (NodeId id = 0; id < g.size(); ++id)
        if (g[id].op == ir::Op::divide) return true;
      return false;
    });
  };
  std::set<int> waiting;  // levels
  for (const Loop& loop : loops)
    if (inwards(loop) && divides(loop)) waiting.insert(level_of(loop));
  for (const Loop& loop : loops)  // elements with the base's coordinates need sums that are complete
    if (!loop.pairs.empty()) waiting.erase(level_of(loop));
  std::vector<Loop> all;
  std::map<int, Loop> open;  // by level: to be joined by others as long as no later level has begun
  for (Loop& loop : loops) {
    const int at = level_of(loop);
    while (!open.empty() && open.begin()->first < at) {
      all.push_back(std::move(open.begin()->second));
      open.erase(open.begin());
    }
    if (!inwards(loop) || !waiting.contains(at)) {
      all.push_back(std::move(loop));
      continue;
    }
    Loop& joint = open[at];
    joint.sweeps.insert(joint.sweeps.end(), loop.sweeps.begin(), loop.sweeps.end());
  }
  for (auto& [at, loop] : open) all.push_back(std::move(loop));
  return all;
}

// The last inwards sweep that the role waits for, directly or not; −1: none.
int Unroll::last_inwards(int role, std::vector<int>& known) const {
  int& last = known[static_cast<std::size_t>(role)];
  if (last != -2) return last;
  last = -1;
  const int s = producer_[static_cast<std::size_t>(role)];
  if (s < 0) return last;
  const ir::Sweep& sweep = algorithm_.sweeps[static_cast<std::size_t>(s)];
  int found = sweep.direction == Direction::inwards ? s : -1;
  for (NodeId id = 0; id < sweep.graph.size(); ++id) {
    const ir::Node& n = sweep.graph[id];
    if (n.op == ir::Op::input && (n.input.kind == InputKind::state || n.input.kind == InputKind::of_body))
      found = std::max(found, last_inwards(n.input.index, known));
  }
  return known[static_cast<std::size_t>(role)] = found;
}

// A recursion outwards and one back and little else: each operation waits for the one before, and what a body needs between the
// two fills the time of the first. Where there are elements, columns or divisions they do.
void Unroll::find_companions() {
  companions_.resize(algorithm_.sweeps.size());
  const bool columns = std::any_of(algorithm_.results.begin(), algorithm_.results.end(),
                                   [](const ir::Result& r) { return r.layout == ir::Layout::columns; });
  if (!algorithm_.pairs.empty() || columns || algorithm_.guard) return;
  std::vector<int> known(algorithm_.roles.size(), -2);
  for (std::size_t a = 0; a < algorithm_.sweeps.size(); ++a) {
    const ir::Sweep& sweep = algorithm_.sweeps[a];
    if (sweep.over.is_base() || sweep.direction != Direction::anywhere) continue;
    int waits_for = -1;
    bool early = true;
    for (NodeId id = 0; id < sweep.graph.size(); ++id) {
      const ir::Node& n = sweep.graph[id];
      if (n.op != ir::Op::input || (n.input.kind != InputKind::state && n.input.kind != InputKind::of_body)) continue;
      early = early && n.input.kind == InputKind::state && last_inwards(n.input.index, known) < 0;
      const int s = producer_[static_cast<std::size_t>(n.input.index)];
      if (s >= 0 && algorithm_.sweeps[static_cast<std::size_t>(s)].direction == Direction::outwards)
        waits_for = std::max(waits_for, s);
    }
    if (early && waits_for >= 0) companions_[static_cast<std::size_t>(waits_for)].push_back(static_cast<int>(a));
  }
}

void Unroll::run_loop(const Loop& loop) {
  const bool inwards =
      loop.sweeps.empty() || algorithm_.sweeps[static_cast<std::size_t>(loop.sweeps.front())].direction == Direction::inwards;
  const auto pairs = [&](int p, int body) {
    run_pairs(p, body);
    turns_[static_cast<std::size_t>(p)][place(body, -1)] = program_.graph.size();
  };
  const int bodies = tree_.joints();
  for (int i = 0; i < bodies; ++i) {
    const int body = inwards ? bodies - 1 - i : i;
    for (int s : loop.sweeps) {
      run_sweep(s, body);
      if (inwards) continue;
      for (int companion : companions_[static_cast<std::size_t>(s)]) run_sweep(companion, body);
    }
    for (int p : loop.pairs) pairs(p, body);
  }
  for (int s : loop.sweeps)
    if (inwards) run_sweep(s, -1);
  for (int p : loop.pairs) pairs(p, -1);
  for (std::size_t p = 0; p < algorithm_.projections.size() && loop.sweeps.empty(); ++p)
    for (int body = tree_.base_coordinates() > 0 ? -1 : 0; body < bodies; ++body) run_projection(static_cast<int>(p), body);
}

void Unroll::run_sweep(int sweep, int body) {
  const auto s = static_cast<std::size_t>(sweep);
  if (done_[s][place(body, -1)]) return;
  done_[s][place(body, -1)] = true;
  const ir::Sweep& from = algorithm_.sweeps[s];
  if (!from.over.contains(tree_, body)) return;
  const ir::Tag outer = tag_;
  const auto set_tag = [&] { program_.graph.set_tag(tag_ = {static_cast<std::int16_t>(sweep), body}); };
  set_tag();
  ir::Copy copy(from.graph, program_.graph);
  const auto of_input = [&](const ir::Input& in) {
    const NodeId id = input(from, in, body);
    set_tag();  // what was asked for may have run other sweeps
    return id;
  };
  std::map<NodeId, NodeId> placed;  // what the body below has told already
  if (from.back && body >= 0 && towards_[static_cast<std::size_t>(body)] >= 0) {
    place_from_below(sweep, body);
    for (const ir::Value& v : from.stores)
      if (const NodeId node = values_[index(place(body, -1), v.role, v.component)]; node != no_node) placed[v.node] = node;
    set_tag();
  }
  const auto copied = [&](NodeId id) {
    const auto known = [&](NodeId node) {
      const auto at = placed.find(node);
      return at == placed.end() ? no_node : at->second;
    };
    return copy.node_until(id, known, of_input);
  };
  const auto wanted = [&](const ir::Value& v) {
    const std::size_t at = live_.at(v.role, v.component);
    return body >= 0 ? live_.body[at] : v.coordinate < 0 ? live_.base[at] : live_.coordinate[at];
  };
  const int parent = body < 0 ? -1 : tree_.bodies[static_cast<std::size_t>(body)].parent;
  const auto handed_on = [&](const ir::Value& v) {
    return body >= 0 && (parent < 0 ? live_.handed_base : live_.handed)[live_.at(v.role, v.component)];
  };
  std::vector<NodeId> all;
  for (const ir::Value& v : from.stores)
    if (wanted(v)) all.push_back(v.node);
  for (const ir::Value& v : from.carries)
    if (handed_on(v)) all.push_back(v.node);
  if (placed.empty()) copy.nodes(all, of_input);
  for (const ir::Value& v : from.stores) {
    if (!wanted(v)) continue;
    const NodeId node = copied(v.node);
    values_[index(place(body, v.coordinate), v.role, v.component)] = node;
    name(node, algorithm_.roles[static_cast<std::size_t>(v.role)], v.component, body);
  }
  for (const ir::Value& v : from.carries) {
    if (!handed_on(v)) continue;
    const NodeId node = copied(v.node);
    NodeId& sum = handed_[index(place(parent, -1), v.role, v.component)];
    sum = sum == no_node ? node : program_.graph.add(sum, node);
  }
  program_.graph.set_tag(tag_ = outer);
}

NodeId Unroll::input(const ir::Sweep& sweep, const ir::Input& in, int body) {
  switch (in.kind) {
    case InputKind::parameter: {
      const bool elsewhere = sweep.first_at_its_joint && body >= 0 && at_its_joint_[static_cast<std::size_t>(body)];
      return elsewhere && is_of_moments(in.index) ? program_.graph.constant(0) : parameter(in.index, body);
    }
    case InputKind::state: return value(in.index, in.component, body);
    case InputKind::of_body: return value(in.index, in.component, in.body);
    case InputKind::carried: {
      if (sweep.direction == Direction::outwards)
        return value(in.index, in.component, tree_.bodies[static_cast<std::size_t>(body)].parent);
      const NodeId sum = handed_[index(place(body, -1), in.index, in.component)];
      return sum == no_node ? program_.graph.constant(0) : sum;
    }
    default: return program_.graph.input(in);
  }
}

NodeId Unroll::value(int role, int component, int body, int coordinate) {
  const std::size_t at = index(place(body, coordinate), role, component);
  if (values_[at] != no_node) return values_[at];
  const ir::Role& r = algorithm_.roles[static_cast<std::size_t>(role)];
  if (r.source != ir::Source::sweep && body >= 0) {
    NodeId node = coordinate_node(program_.graph, r, tree_, coordinates_, positions_, scene_.rates_zero, body);
    if (r.source == ir::Source::effort) node = implicit_effort(node, body);
    name(node, r, component, body);
    return values_[at] = node;
  }
  const int own = producer_[static_cast<std::size_t>(role)], base = base_producer_[static_cast<std::size_t>(role)];
  if (body < 0 && base >= 0) run_sweep(base, -1);
  if (values_[at] == no_node && own >= 0 && coordinate < 0) run_sweep(own, body);
  if (values_[at] == no_node) values_[at] = program_.graph.constant(0);
  return values_[at];
}

NodeId Unroll::kept(int role, int component, int body) {
  const bool coordinate = algorithm_.roles[static_cast<std::size_t>(role)].source != ir::Source::sweep;
  return coordinate && body >= 0 ? value(role, component, body) : this->role(role, component, body);
}

NodeId Unroll::plain_parameter(int parameter, int body) {
  double value = parameter_value(parameter, tree_, normal_, body);
  if (parameter == axis_inertia_p && body >= 0 && at_its_joint_[static_cast<std::size_t>(body)])
    value += inertia_about_axis(tree_, normal_, body);
  return program_.graph.constant(value);
}

NodeId Unroll::parameter(int parameter, int body) {
  const NodeId constant = plain_parameter(parameter, body);
  const NodeId added = added_parameter(parameter, body);
  return added == no_node ? constant : program_.graph.add(constant, added);
}

NodeId Unroll::added_parameter(int parameter, int body) const {
  const auto& added = payload_[place(body, -1)];
  const auto at = added.find(parameter);
  return at == added.end() ? no_node : at->second;
}

NodeId Unroll::factor(std::size_t place, int role, int component) {
  const int body = static_cast<int>(place) - 1, bodies = tree_.joints();
  return body < bodies ? value(role, component, body) : value(role, component, -1, body - bodies);
}

NodeId Unroll::dot(const std::vector<ir::PairTerm>& terms, std::size_t lower, std::size_t upper) {
  ir::Graph& g = program_.graph;
  NodeId sum = no_node;
  for (const ir::PairTerm& t : terms) {
    NodeId three[3];
    for (int i : {2, 1, 0}) {
      const NodeId a = factor(lower, t.lower, t.lower_from + i), b = factor(upper, t.upper, t.upper_from + i);
      g.set_tag(tag_);
      three[i] = g.multiply(a, b);
    }
    const NodeId part = g.add(g.add(three[0], three[1]), three[2]);
    sum = sum == no_node ? part : g.add(sum, part);
  }
  return sum;
}

// Body k with itself, with the bodies above it, and with the base's coordinates.
void Unroll::run_pairs(int pairs, int body) {
  const ir::Pairs& p = algorithm_.pairs[static_cast<std::size_t>(pairs)];
  program_.graph.set_tag(tag_ = tag_of(pairs, body));
  const ir::OutputArray& array = algorithm_.arrays[static_cast<std::size_t>(p.array)];
  const bool base_asked = base_rows_ > 0 && array.row(0) >= 0;
  const auto asked = [&](int b) { return array.row(row_of(b)) >= 0; };
  if (body >= 0 && !asked(body)) return;
  if (body < 0) {  // the base with itself: every element by its column
    for (int k = 0; k < base_rows_ && base_asked; ++k)
      for (int i = 0; i < base_rows_; ++i) put(p.array, i, k, dot(p.above, place(-1, k), place(-1, i)));
    return;
  }
  const std::size_t lower = place(body, -1);
  bool known = false;
  for (int i = body; i >= 0 && !known; i = tree_.bodies[static_cast<std::size_t>(i)].parent) {
    known = is_known(pairs, body, i);
    if (!asked(i)) continue;
    NodeId above = dot(p.above, lower, place(i, -1));
    if (i == body && p.diagonal >= 0) above = program_.graph.add(above, parameter(p.diagonal, body));
    put(p.array, row_of(i), row_of(body), above);
    if (i == body) continue;
    if (p.symmetric) put(p.array, row_of(body), row_of(i), above);
    if (!p.below.empty()) put(p.array, row_of(body), row_of(i), dot(p.below, lower, place(i, -1)));
  }
  // Of a joint's parts the first comes last: all forces are there.
  if (p.between >= 0 && tree_.bodies[static_cast<std::size_t>(body)].has_quaternion())
    each_bracket(tree_, body, [&](int under, int over, int along, int sign) {
      const NodeId force = value(p.between, 0, along);
      program_.graph.set_tag(tag_);
      put(p.array, row_of(over), row_of(under), sign > 0 ? force : program_.graph.negate(force));
    });
  for (int j = 0; j < base_rows_ && base_asked; ++j) {
    const NodeId above = dot(p.above, lower, place(-1, j));
    put(p.array, j, row_of(body), above);
    if (p.symmetric) put(p.array, row_of(body), j, above);
    if (!p.below.empty()) put(p.array, row_of(body), j, dot(p.below, lower, place(-1, j)));
  }
}

void Unroll::run_projection(int projection, int body) {
  const ir::Projection& p = algorithm_.projections[static_cast<std::size_t>(projection)];
  const int filling = static_cast<int>(algorithm_.pairs.size()) + projection;
  const int columns = static_cast<int>(p.columns.size()), link = body < 0 ? 0 : links_[static_cast<std::size_t>(body)];
  if (link < 0) return;
  const int first = columns * link;
  const ir::OutputArray& array = algorithm_.arrays[static_cast<std::size_t>(p.array)];
  if (array.column(first) < 0) return;
  const auto project = [&](int row, int above, int coordinate) {
    if (array.row(row) < 0) return;
    tag_ = tag_of(filling, body);
    ir::Copy copy(p.graph, program_.graph);
    for (int c = 0; c < columns; ++c) {
      const NodeId node = copy.node(p.columns[static_cast<std::size_t>(c)], [&](const ir::Input& in) {
        const NodeId id = in.kind == InputKind::state ? value(in.index, in.component, body)
                                                      : value(in.index, in.component, above, coordinate);
        program_.graph.set_tag(tag_);
        return id;
      });
      put(p.array, row, first + c, node);
    }
  };
  bool known = false;
  for (int i = body; i >= 0 && !known; i = tree_.bodies[static_cast<std::size_t>(i)].parent) {
    known = is_known(filling, body, i);
    project(row_of(i), i, -1);
  }
  for (int j = 0; j < base_rows_; ++j) project(j, -1, j);
}

// Adds to an element: a driven joint's share falls on its driver's row and column.
void Unroll::put(int array, int row, int column, NodeId node) {
  const ir::OutputArray& part = algorithm_.arrays[static_cast<std::size_t>(array)];
  row = part.row(row), column = part.column(column);
  if (row < 0 || column < 0) return;  // not asked for
  if (column_is_ == Column::met) return;
  if (column_is_ == Column::counted && each_alone_) {
    column_.emplace_back(array, node);
    return;
  }
  if (column_is_ == Column::counted) sums_.emplace_back(array, column, row);
  const auto [at, made] = elements_.try_emplace({array, column, row}, node);
  if (!made) at->second = program_.graph.add(at->second, node);
}

void Unroll::collect_results() {
  for (const ir::Result& r : algorithm_.results) {
    const int count = algorithm_.roles[static_cast<std::size_t>(r.role)].components();
    for (int i = 0; i < count; ++i) {
      if (r.layout == ir::Layout::base) {
        const int rows = algorithm_.arrays[static_cast<std::size_t>(r.array)].rows;
        put(r.array, (r.from + i) % rows, (r.from + i) / rows, value(r.role, i, -1));
        continue;
      }
      const bool columns = r.layout == ir::Layout::columns;
      const ir::OutputArray& array = algorithm_.arrays[static_cast<std::size_t>(r.array)];
      const auto asked = [&](int at) { return (columns ? array.column(at) : array.row(at)) >= 0; };
      for (int k = 0; k < tree_.joints(); ++k)
        if (asked(row_of(k))) put(r.array, columns ? r.from + i : row_of(k), columns ? row_of(k) : 0, value(r.role, i, k));
      for (int j = 0; j < base_rows_; ++j)
        if (asked(j)) put(r.array, columns ? r.from + i : j, columns ? j : 0, value(r.role, i, -1, j));
    }
  }
  for (const auto& [key, node] : elements_)
    if (!program_.graph.is_constant(node, 0))
      program_.elements.push_back({std::get<0>(key), std::get<2>(key), std::get<1>(key), node});
  elements_.clear();
  if (options_.names) program_.names.resize(static_cast<std::size_t>(program_.graph.size()));
}

void Unroll::name(NodeId node, const ir::Role& role, int component, int body) {
  if (!options_.names) return;
  const ir::Op op = program_.graph[node].op;
  if (op == ir::Op::constant || op == ir::Op::input) return;
  const auto at = static_cast<std::size_t>(node);
  if (program_.names.size() <= at) program_.names.resize(at + 64);
  if (!program_.names[at].empty()) return;
  const std::string suffix = ir::component_suffix(role.shape, component);
  program_.names[at] = role.symbol + (suffix.empty() ? "" : "_" + suffix) + "_" +
                       (body < 0 ? "base" : ir::identifier(tree_.bodies[static_cast<std::size_t>(body)].joint));
}

}  // namespace dalembert::passes
