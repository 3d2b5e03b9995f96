#include "passes/normalise.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

#include "ir/rotation.hpp"
#include "passes/joints/displacement.hpp"

namespace dalembert::passes {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// A rotation whose z axis is `axis`. Coordinate axes give permutations, which cost nothing and round nothing. An axis 1e-9 off
// has a 1 there as well: the other entries tell.
Matrix3d frame_with_z(const Vector3d& axis) {
  constexpr double dust = 2.3e-16;  // less than the rounding of what it is multiplied with
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    if (std::abs(axis[i]) != 1 || std::abs(axis[j]) >= dust || std::abs(axis[k]) >= dust) continue;
    Matrix3d frame = Matrix3d::Zero();
    frame(j, 0) = 1;
    frame(k, 1) = axis[i];
    frame(i, 2) = axis[i];
    return frame;
  }
  int least = 0;
  axis.cwiseAbs().minCoeff(&least);
  Matrix3d frame;
  frame.col(2) = axis;
  frame.col(0) = Vector3d::Unit(least).cross(axis).normalized();
  frame.col(1) = axis.cross(frame.col(0));
  return frame;
}

ir::Moments moments_of(const ir::Inertia& body, const Matrix3d& frame) {
  const Matrix3d inertia = 0.5 * (body.inertia + body.inertia.transpose());
  const double half_trace = 0.5 * inertia.trace();
  ir::Moments m;
  m.mass = body.mass;
  m.first = frame.transpose() * (body.mass * body.com);
  const Matrix3d second = half_trace * Matrix3d::Identity() - inertia + body.mass * body.com * body.com.transpose();
  m.second = frame.transpose() * second * frame;
  m.second = (0.5 * (m.second + m.second.transpose())).eval();
  m.half_trace = half_trace;
  return m;
}

bool has_inertia(const ir::Moments& own) { return own.mass != 0 || !own.second.isZero(0); }

void add_to_parent(ir::Moments& parent, const ir::Moments& m, const Matrix3d& r, const Vector3d& p) {
  const Vector3d first = r * m.first;
  parent.mass += m.mass;
  parent.first += first + m.mass * p;
  parent.second += r * m.second * r.transpose() + first * p.transpose() + p * first.transpose() + m.mass * p * p.transpose();
  parent.half_trace += m.half_trace;
}

// The same mass distribution about a point `by` further along z.
void shift_origin(ir::Moments& m, double by) {
  const Vector3d d(0, 0, by), first = m.first;
  m.first -= m.mass * d;
  m.second += -first * d.transpose() - d * first.transpose() + m.mass * d * d.transpose();
}

int nonzeros(const Vector3d& v) { return static_cast<int>((v.array() != 0).count()); }

// The origin of the frame of a joint that turns may be anywhere on its axis: level with the next joint's, where that makes more
// components of translations zero: fewer operations, and as a rule shorter levers and less rounding.
void slide_origins(ir::NormalTree& tree, bool base_moves) {
  for (size_t k = tree.bodies.size(); k-- > 0;) {
    ir::NormalBody& n = tree.bodies[k];
    if (n.turning == 0) continue;
    std::vector<ir::NormalBody*> children;
    for (size_t c = k + 1; c < tree.bodies.size(); ++c)
      if (tree.bodies[c].parent == static_cast<int>(k)) children.push_back(&tree.bodies[c]);
    if (children.empty()) continue;
    const double by = children.front()->translation.z();
    const Vector3d translation = n.translation + by * n.rotation.col(2);
    // On a fixed base nobody reads where the first body is.
    const bool read = n.parent >= 0 || base_moves;
    int more = read ? nonzeros(translation) - nonzeros(n.translation) : 0;
    for (const ir::NormalBody* c : children) more += (c->translation.z() != by) - (c->translation.z() != 0);
    if (more >= 0) continue;
    for (ir::NormalBody* c : children) c->translation.z() -= by;
    n.translation = translation;
    n.link_translation.z() -= by;
    shift_origin(n.own, by);
    n.moments = n.own;
  }
}

}  // namespace

NormaliseOptions normalise_options(const ir::Scene& scene, bool move_parameters) {
  const auto matrix = [](ir::Quantity q) { return q == ir::Quantity::mass_matrix || q == ir::Quantity::coriolis_matrix; };
  const std::vector<ir::Quantity> asked = scene.quantities();
  return {move_parameters, std::any_of(asked.begin(), asked.end(), matrix)};
}

ir::NormalTree normalise(const ir::KinematicTree& tree, const NormaliseOptions& options) {
  ir::NormalTree normal;
  normal.base = moments_of(tree.base, Matrix3d::Identity());
  normal.bodies.resize(tree.bodies.size());
  for (size_t k = 0; k < tree.bodies.size(); ++k) {
    const ir::Body& body = tree.bodies[k];
    ir::NormalBody& n = normal.bodies[k];
    const Matrix3d frame = frame_with_z(body.axis);
    Matrix3d parent_frame = Matrix3d::Identity();
    if (body.parent >= 0) parent_frame = normal.bodies[static_cast<size_t>(body.parent)].link_rotation.transpose();
    n.parent = body.parent;
    n.turning = body.turns() ? 1 : 0;
    n.sliding = body.slide_per_unit();
    n.rotation = ir::without_rounding_dust(parent_frame.transpose() * body.placement.linear() * frame);
    n.translation = parent_frame.transpose() * body.placement.translation();
    n.link_rotation = frame.transpose();
    n.own = n.moments = moments_of(body.inertia, frame);
  }
  if (options.slide_origins) slide_origins(normal, tree.base_coordinates() > 0);
  if (!options.move_parameters) return normal;
  for (size_t k = normal.bodies.size(); k-- > 0;) {
    ir::NormalBody& n = normal.bodies[k];
    // A link without inertia, as in a joint of several axes, costs nothing as long as nothing moves there.
    if (n.parent >= 0 && !has_inertia(normal.bodies[static_cast<size_t>(n.parent)].own)) continue;
    n.moved = take_movable(n.moments, n.turning != 0, n.sliding != 0);
    // A joint that slides does so along z, which changes nothing in what moves: no mass, no first moment.
    ir::Moments& parent = n.parent < 0 ? normal.base : normal.bodies[static_cast<size_t>(n.parent)].moments;
    add_to_parent(parent, n.moved, n.rotation, n.translation);
  }
  return normal;
}

}  // namespace dalembert::passes
