#include "ir/linkage.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {
LinkagePlaces linkage_places(const Linkage& linkage, const KinematicTree& tree) {
  LinkagePlaces places;
  const std::vector<int> positions = tree.positions(), coordinates = tree.coordinates();
  const int base = tree.base_coordinates();
  for (const int k : linkage.dependent)
    places.positions.push_back(tree.base_positions() + positions[static_cast<std::size_t>(k)]);
  for (const int k : linkage.independent) places.followed.push_back(base + coordinates[static_cast<std::size_t>(k)]);
  return places;
}

EvaluatedRows::EvaluatedRows(const Linkage& linkage, const KinematicTree& tree)
    : dependent(static_cast<int>(linkage.dependent.size())),
      independent(static_cast<int>(linkage.independent.size())),
      rows_(linkage_rows(linkage, tree)),
      values_(static_cast<std::size_t>(rows_.graph.size())) {
  const LinkagePlaces places = linkage_places(linkage, tree);
  positions = places.positions;
  followed = places.followed;
}

void EvaluatedRows::at(const double* q, double (&error)[most_dependent], double (&J)[most_dependent][most_columns]) {
  const double at_rest[most_columns] = {};
  evaluate(q, at_rest);
  for (std::size_t r = 0; r < rows_.error.size(); ++r) error[r] = values_[static_cast<std::size_t>(rows_.error[r])];
  fill(rows_.jacobian, J);
}

void EvaluatedRows::rates(const double* q, const double* rate, double (&J_rate)[most_dependent][most_columns]) {
  evaluate(q, rate);
  fill(rows_.rate, J_rate);
}

void EvaluatedRows::evaluate(const double* q, const double* rate) {
  for (NodeId id = 0; id < rows_.graph.size(); ++id) {
    const Node& n = rows_.graph[id];
    const auto of = [&](NodeId operand) { return values_[static_cast<std::size_t>(operand)]; };
    double& value = values_[static_cast<std::size_t>(id)];
    switch (n.op) {
      case Op::constant: value = n.value; break;
      case Op::input: value = n.input.kind == InputKind::position ? q[n.input.index] : rate[n.input.index]; break;
      case Op::sine: value = std::sin(of(n.a)); break;
      case Op::cosine: value = std::cos(of(n.a)); break;
      case Op::sign: value = of(n.a) > 0 ? 1 : of(n.a) < 0 ? -1 : of(n.a); break;
      case Op::negate: value = -of(n.a); break;
      case Op::add: value = of(n.a) + of(n.b); break;
      case Op::subtract: value = of(n.a) - of(n.b); break;
      case Op::multiply: value = of(n.a) * of(n.b); break;
      case Op::divide: value = of(n.a) / of(n.b); break;
      case Op::where: value = of(n.a) > 0 ? of(n.b) : 0; break;
    }
  }
}

void EvaluatedRows::fill(const std::vector<std::vector<NodeId>>& matrix, double (&to)[most_dependent][most_columns]) const {
  for (std::size_t r = 0; r < matrix.size(); ++r)
    for (std::size_t c = 0; c < matrix[r].size(); ++c) to[r][c] = values_[static_cast<std::size_t>(matrix[r][c])];
}

Followers followers(const KinematicTree& tree) {
  const KinematicTree opened = tree.opened();
  const std::vector<int> all = opened.coordinates(), own = tree.coordinates();
  const int base = tree.base_coordinates();
  Followers f;
  f.all = opened.nv();
  for (int j = 0; j < base; ++j) f.at.push_back(j);
  for (std::size_t k = 0; k < tree.bodies.size(); ++k)
    if (tree.bodies[k].independent()) f.at.push_back(base + all[k]);
  for (const Linkage& linkage : tree.linkages)
    for (const int d : linkage.dependent)
      for (const int y : linkage.independent)
        f.elements.push_back({base + all[static_cast<std::size_t>(d)], base + own[static_cast<std::size_t>(y)]});
  return f;
}

LinkageStatus<double> close_loops(const KinematicTree& tree, int steps, Eigen::VectorXd& q) {
  LinkageStatus<double> status;
  for (std::size_t i = 0; i < tree.linkages.size(); ++i) {
    EvaluatedRows rows(tree.linkages[i], tree);
    close_linkage(rows, static_cast<int>(i), steps, q.data(), status);
  }
  return status;
}

// How far apart a linkage's bodies and loops are at most, were its joints in one line, m; half a metre at least.
static double reach(const Linkage& linkage, const KinematicTree& tree) {
  double sum = 0;
  for (const std::vector<int>* joints : {&linkage.dependent, &linkage.independent})
    for (const int k : *joints) sum += tree.bodies[static_cast<std::size_t>(k)].placement.translation().norm();
  for (const LinkageLoop& loop : linkage.loops)
    sum += loop.length + loop.frames[0].translation().norm() + loop.frames[1].translation().norm();
  return std::max(sum, 0.5);
}

ClosedState draw_closed(const KinematicTree& tree, Eigen::VectorXd& q, int tries, double least_pivot, bool from_q) {
  constexpr int patient = 60;
  constexpr double closed = 1e-12;  // m, rad: rounding
  const std::vector<int> positions = tree.positions();
  ClosedState state;
  std::mt19937_64 engine(31);  // whose numbers are the same on every system
  const auto uniform = [&](double least, double most) {
    return least + (most - least) * (static_cast<double>(engine() >> 11) * 0x1p-53);
  };
  // Anywhere; of slides every other time within their limits, for a cylinder's zero may be far from where it works.
  const auto draw = [&](const Body& body, double reach, bool within) {
    if (body.turns()) return uniform(-std::numbers::pi, std::numbers::pi);
    const Limits& limits = body.limits;
    const double far = 100 * reach;  // limits of who means none
    if (within && -far < limits.lower && limits.lower < limits.upper && limits.upper < far)
      return uniform(limits.lower, limits.upper);
    return uniform(-reach, reach);
  };
  for (int i = 0; i < tries && !state.closed; ++i) {
    for (const Linkage& linkage : tree.linkages) {
      const double far = reach(linkage, tree);
      for (const std::vector<int>* joints : {&linkage.dependent, &linkage.independent})
        for (const int k : *joints) {
          const Body& body = tree.bodies[static_cast<std::size_t>(k)];
          double& position = q[tree.base_positions() + positions[static_cast<std::size_t>(k)]];
          // Where joints are first is kept for the independent ones.
          if (i > 0 || !from_q) {
            const double drawn = draw(body, far, i % 2 == 1);
            if (i > tries / 4 || body.follows) position = drawn;
          }
        }
    }
    Eigen::VectorXd start = q;
    const double pivot = close_loops(tree, 1, start).least_pivot;
    const LinkageStatus<double> status = close_loops(tree, patient, q);
    if (i == 0 || status.error < state.least_error) state.least_error = status.error;
    state.most_regular = std::max({state.most_regular, pivot, status.least_pivot});
    state.closed = status.error < closed && status.least_pivot > least_pivot;
  }
  return state;
}

}  // namespace dalembert::ir
