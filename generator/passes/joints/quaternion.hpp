// Joints whose orientation is a unit quaternion, alone or behind three displacements.
//
// Such a joint is a row of bodies on the axes of its child, which stand still in the link: so their rates are those of axes
// that turn with the link itself, V x S, and not, as along a chain of joints, with the body above. The first body has the
// joint's pose and all its motion, the others rest on it; each has its own axis, force and acceleration. Then whatever takes
// axes, poses and velocities body by body finds them right.
#pragma once

#include <map>
#include <vector>

#include "ir/graph.hpp"
#include "ir/kinematic_tree.hpp"
#include "ir/normal_tree.hpp"

namespace dalembert::passes {

// What q and v give at run time of the parameters of a body that has a quaternion: its frame in the parent's, and its joint's
// motion along its own axes; parameter → node. Empty of every other body.
std::map<int, ir::NodeId> quaternion_parameters(ir::Graph& graph, const ir::KinematicTree& tree, const ir::NormalTree& normal,
                                                const std::vector<int>& positions, const std::vector<int>& coordinates,
                                                bool rates_zero, int body);

// Of such a joint's parts, the upper one's index and the lower one's: the part whose axis is their cross product, lower x
// upper, and its sign; 0: they commute.
struct Bracket {
  int part = 0;
  int sign = 0;
};
Bracket bracket(const ir::Body& lower, const ir::Body& upper);

// Calls action(lower, upper, body, sign) for every two parts that do not commute of the joint that begins at a body, `body`
// being their product's part.
template <class Action>
void each_bracket(const ir::KinematicTree& tree, int first, const Action& action) {
  for (int k = first; k < first + tree.bodies[static_cast<std::size_t>(first)].parts; ++k)
    for (int i = first; i < k; ++i)
      if (const Bracket found = bracket(tree.bodies[static_cast<std::size_t>(k)], tree.bodies[static_cast<std::size_t>(i)]);
          found.sign != 0)
        action(k, i, first + found.part, found.sign);
}

}  // namespace dalembert::passes
