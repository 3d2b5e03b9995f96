// Whether M is singular wherever the robot stands.
#pragma once

#include <optional>
#include <vector>

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"

namespace dalembert::reference {

// A motion that moves no mass: v with M v = 0.
struct MotionWithoutMass {
  bool base = false;        // whether the base takes part
  std::vector<int> bodies;  // whose joints take part, in the tree's order
};

// Such a motion, if there is one in every state: a base without mass that turns about its first joint's axis while the joint
// turns back, a bar without thickness about itself, links without mass between parallel axes. A payload given at run time
// counts as a mass.
//
// M is eliminated from the tips to the base, in time in proportion to the bodies: what is left of a joint's inertia is its
// pivot D = sᵀ Iᴬ s (Featherstone 2008, ch. 7), and M is singular where one is zero. In double that clears almost every robot:
// no pivot is less than 1e-10 of the element of M it is left of. Of the others the pivots are computed in 50 digits at three
// states drawn at random, beside those of two robots that differ from this one by rounding (each number by 1e-15 of itself): a
// pivot is zero when it is nothing to 40 digits, or changes by as much as it is. So it does not matter how light a part is: a
// base of 1e-12 kg keeps its pivots whatever the last digits are, and two axes that coincide to rounding do not.
//
// Says nothing of a robot whose M is not positive semidefinite, for inertias that no body has. Of a robot with driven joints it
// finds single motions that obey the relations, and not their combinations.
std::optional<MotionWithoutMass> motion_without_mass(const ir::KinematicTree& tree, const ir::Scene& scene);

}  // namespace dalembert::reference
