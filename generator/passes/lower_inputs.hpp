// The symbolic inputs of a robot: positions, rates, gravity, payloads, and the constants of its bodies.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"
#include "ir/scene.hpp"
#include "passes/equations.hpp"

namespace dalembert::passes {

// Makes the nodes of one robot's inputs and constants in a graph. References the tree, its normal form and the scene.
class LowerInputs {
 public:
  LowerInputs(ir::Graph& graph, const ir::KinematicTree& tree, const ir::NormalTree& normal, const ir::Scene& scene);

  Sym constant(double value) const { return {&graph_, graph_.constant(value)}; }
  Vec3 constant(const Eigen::Vector3d& v) const { return {constant(v[0]), constant(v[1]), constant(v[2])}; }
  Mat3 constant(const Eigen::Matrix3d& m) const;
  Vec3 zero() const { return constant(Eigen::Vector3d(Eigen::Vector3d::Zero())); }

  // Of the joint above a body: sine and cosine, or displacement (m); rate (rad/s or m/s), zero in statics. A driven joint's are
  // its driver's, scaled.
  JointPosition position(size_t body) const;
  Sym rate(size_t body) const;
  Twist base_twist() const;      // floating base: v's first six; fixed: zero
  Vec3 gravity_in_base() const;  // gravity along the base's axes: the world's on a fixed base
  // Constants of a body, or of the base, with what the scene's payloads add.
  BodyConstants body(size_t k) const { return constants(normal_.bodies[k], static_cast<int>(k)); }
  BodyConstants base() const;

 private:
  Sym input(ir::InputKind kind, int index, int component = 0) const;
  BodyConstants constants(const ir::NormalBody& n, int body) const;
  void add_payloads(BodyConstants& c, int body, const ir::Moments& own, const Eigen::Matrix3d& link_rotation,
                    const Eigen::Vector3d& link_translation) const;

  ir::Graph& graph_;
  const ir::KinematicTree& tree_;
  const ir::NormalTree& normal_;
  const ir::Scene& scene_;
  std::vector<int> coordinates_;
};

}  // namespace dalembert::passes
