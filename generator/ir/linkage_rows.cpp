#include "ir/linkage_rows.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ir/kinematic_tree.hpp"

namespace dalembert::ir {
namespace {

// A node, with the operations of a number.
struct Symbol {
  Graph* graph = nullptr;
  NodeId node = no_node;
  friend Symbol operator+(Symbol a, Symbol b) { return {a.graph, a.graph->add(a.node, b.node)}; }
  friend Symbol operator-(Symbol a, Symbol b) { return {a.graph, a.graph->subtract(a.node, b.node)}; }
  friend Symbol operator*(Symbol a, Symbol b) { return {a.graph, a.graph->multiply(a.node, b.node)}; }
};
using Three = std::array<Symbol, 3>;

Three operator+(const Three& a, const Three& b) { return {a[0] + b[0], a[1] + b[1], a[2] + b[2]}; }
Three operator-(const Three& a, const Three& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Three operator*(Symbol s, const Three& a) { return {s * a[0], s * a[1], s * a[2]}; }
Three cross(const Three& a, const Three& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Symbol dot(const Three& a, const Three& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// A frame's axes as columns, its origin, and how they move.
struct Place {
  std::array<Three, 3> axes;
  Three x, velocity, spin;

  Three along(const Three& a) const { return a[0] * axes[0] + a[1] * axes[1] + a[2] * axes[2]; }
};

// A joint on its way: what it does per unit of its coordinate, the point it turns about, and how they move.
struct MovingAxis {
  int column;
  Three turning, sliding, origin, velocity, turning_rate, sliding_rate;
};

class Tracing {
 public:
  Tracing(const Linkage& linkage, const KinematicTree& tree)
      : linkage_(linkage), tree_(tree), positions_(tree.positions()), columns_(linkage.dependent) {
    columns_.insert(columns_.end(), linkage.independent.begin(), linkage.independent.end());
  }

  LinkageRows run() && {
    const std::vector<NodeId> zeros(columns_.size(), rows_.graph.constant(0));
    for (const LinkageLoop& loop : linkage_.loops) {
      const size_t first = rows_.error.size(), count = static_cast<size_t>(loop.rows());
      rows_.jacobian.insert(rows_.jacobian.end(), count, zeros);
      rows_.rate.insert(rows_.rate.end(), count, zeros);
      const std::array<Place, 2> ends = {walk(loop, 0), walk(loop, 1)};
      add_errors(loop, ends);
      for (size_t side = 0; side < 2; ++side)
        for (const MovingAxis& joint : axes_[side]) add_column(loop, ends, side, joint, first);
    }
    return std::move(rows_);
  }

 private:
  Symbol number(double x) { return {&rows_.graph, rows_.graph.constant(x)}; }
  Symbol input(InputKind kind, int index) { return {&rows_.graph, rows_.graph.input({kind, index})}; }
  Three numbers(const Eigen::Vector3d& x) { return {number(x[0]), number(x[1]), number(x[2])}; }

  Place shifted(const Place& at, const Eigen::Isometry3d& frame) {
    const Three arm = at.along(numbers(frame.translation()));
    return {turned(at, {numbers(frame.linear().col(0)), numbers(frame.linear().col(1)), numbers(frame.linear().col(2))}),
            at.x + arm, at.velocity + cross(at.spin, arm), at.spin};
  }
  static std::array<Three, 3> turned(const Place& at, const std::array<Three, 3>& by) {
    return {at.along(by[0]), at.along(by[1]), at.along(by[2])};
  }
  // About an axis of unit length, by Rodrigues' formula.
  std::array<Three, 3> rotation(const Eigen::Vector3d& axis, Symbol angle) {
    const Symbol s{&rows_.graph, rows_.graph.sine(angle.node)}, c{&rows_.graph, rows_.graph.cosine(angle.node)},
        v = number(1) - c;
    std::array<Three, 3> columns;
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        const int other = 3 - i - k;
        const Symbol product = v * number(axis[i] * axis[k]);
        columns[static_cast<size_t>(k)][static_cast<size_t>(i)] =
            i != k                     ? product + s * number((k == (i + 1) % 3 ? -1 : 1) * axis[other])
            : std::abs(axis[i]) == 1.0 ? number(1)
                                       : c + product;
      }
    return columns;
  }

  // To the frame on one of a loop's links, from what both hang on.
  Place walk(const LinkageLoop& loop, size_t side) {
    const Three none = numbers(Eigen::Vector3d::Zero());
    Place at{{numbers(Eigen::Vector3d::UnitX()), numbers(Eigen::Vector3d::UnitY()), numbers(Eigen::Vector3d::UnitZ())},
             none,
             none,
             none};
    axes_[side].clear();
    for (const int k : loop.joints[side]) {
      const Body& body = tree_.bodies[static_cast<size_t>(k)];
      at = shifted(at, body.placement);
      const int column = static_cast<int>(std::find(columns_.begin(), columns_.end(), k) - columns_.begin());
      const Symbol q = input(InputKind::position, tree_.base_positions() + positions_[static_cast<size_t>(k)]),
                   rate = input(InputKind::velocity, column);
      const Three axis = at.along(numbers(body.axis));
      MovingAxis moving{
          column, number(body.turns() ? 1 : 0) * axis, number(body.slide_per_unit()) * axis, at.x, at.velocity, none, none};
      moving.turning_rate = cross(at.spin, moving.turning);
      moving.sliding_rate = cross(at.spin, moving.sliding);
      const Three arm = q * moving.sliding;
      at.velocity = at.velocity + cross(at.spin, arm) + rate * moving.sliding;
      at.x = at.x + arm;
      at.spin = at.spin + rate * moving.turning;
      if (body.turns()) at.axes = turned(at, rotation(body.axis, q));
      axes_[side].push_back(moving);
    }
    return shifted(at, loop.frames[side]);
  }

  // As constraints' rows have them: xb - xa; (|xb - xa|^2 - l^2) / 2 l; za x zb, or half the sum of a_i x b_i.
  void add_errors(const LinkageLoop& loop, const std::array<Place, 2>& ends) {
    const Three between = ends[1].x - ends[0].x;
    if (loop.length > 0) {
      rows_.error.push_back(((dot(between, between) - number(loop.length * loop.length)) * number(1 / (2 * loop.length))).node);
      return;
    }
    for (const int i : loop.linear) rows_.error.push_back(dot(ends[0].axes[static_cast<size_t>(i)], between).node);
    Three apart = cross(ends[0].axes[2], ends[1].axes[2]);
    if (loop.angular.size() == 3)
      apart = number(0.5) * (apart + cross(ends[0].axes[0], ends[1].axes[0]) + cross(ends[0].axes[1], ends[1].axes[1]));
    for (const int i : loop.angular) rows_.error.push_back(dot(ends[0].axes[static_cast<size_t>(i)], apart).node);
  }

  void add_column(const LinkageLoop& loop, const std::array<Place, 2>& ends, size_t side, const MovingAxis& joint, size_t row) {
    const Symbol sign = number(side == 1 ? 1 : -1);
    // Of the rows' point, moved with this joint: the second link's, and of a distance each link's own.
    const bool distance = loop.length > 0;
    const Place& point = ends[distance ? side : 1];
    const Three arm = point.x - joint.origin, moved = sign * (cross(joint.turning, arm) + joint.sliding),
                moved_rate = sign * (cross(joint.turning_rate, arm) + cross(joint.turning, point.velocity - joint.velocity) +
                                     joint.sliding_rate),
                turned = sign * joint.turning, turned_rate = sign * joint.turning_rate;
    const auto add = [&](Symbol element, Symbol rate) {
      const auto to = [&](std::vector<std::vector<NodeId>>& matrix, Symbol x) {
        NodeId& at = matrix[row][static_cast<size_t>(joint.column)];
        at = rows_.graph.add(at, x.node);
      };
      to(rows_.jacobian, element);
      to(rows_.rate, rate);
      ++row;
    };
    if (distance) {
      const Three between = ends[1].x - ends[0].x, opening = ends[1].velocity - ends[0].velocity;
      const Symbol scale = number(1 / loop.length);
      return add(scale * dot(between, moved), scale * (dot(opening, moved) + dot(between, moved_rate)));
    }
    for (const int i : loop.linear) {
      const Three& axis = ends[0].axes[static_cast<size_t>(i)];
      add(dot(axis, moved), dot(cross(ends[0].spin, axis), moved) + dot(axis, moved_rate));
    }
    for (const int i : loop.angular) {
      const Three& axis = ends[0].axes[static_cast<size_t>(i)];
      add(dot(axis, turned), dot(cross(ends[0].spin, axis), turned) + dot(axis, turned_rate));
    }
  }

  const Linkage& linkage_;
  const KinematicTree& tree_;
  const std::vector<int> positions_;
  std::vector<int> columns_;  // bodies
  std::array<std::vector<MovingAxis>, 2> axes_;
  LinkageRows rows_;
};

}  // namespace

std::vector<NodeId> LinkageRows::at_rest() const {
  std::vector<NodeId> nodes = error;
  for (const std::vector<NodeId>& row : jacobian) nodes.insert(nodes.end(), row.begin(), row.end());
  return nodes;
}
std::vector<NodeId> LinkageRows::moving() const {
  std::vector<NodeId> nodes;
  for (const std::vector<NodeId>& row : rate) nodes.insert(nodes.end(), row.begin(), row.end());
  return nodes;
}

LinkageRows linkage_rows(const Linkage& linkage, const KinematicTree& tree) { return Tracing(linkage, tree).run(); }

}  // namespace dalembert::ir
