// What the functions of a scene depend on: which inputs, and which constants of the bodies, their results are made of.
#pragma once

#include <set>

#include "ir/graph.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"
#include "passes/parameters.hpp"

namespace dalembert::passes {

class Reads {
 public:
  // Of all functions of the scene, by their equations. What is handed to a kernel counts, whether or not the kernel needs it,
  // and zeros of the robot's own numbers are not looked at.
  Reads(const ir::KinematicTree& tree, const ir::Scene& scene);

  bool input(ir::InputKind kind) const { return inputs_.contains(kind); }
  bool parameter(Parameter parameter) const { return parameters_.contains(parameter); }
  // A mass, a centre of mass or an inertia.
  bool mass() const;

 private:
  std::set<ir::InputKind> inputs_;
  std::set<int> parameters_;
};

}  // namespace dalembert::passes
