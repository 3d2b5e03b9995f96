// The expected results behind the emitted self-test.
#pragma once

#include "ir/kinematic_tree.hpp"
#include "ir/scene.hpp"
#include "ir/self_test.hpp"

namespace dalembert::reference {

// States, run-time inputs and what the scene's outputs are there, in the order of passes::output_arrays(). No input is zero,
// no angle near a multiple of a right angle, no two coordinates alike; the same in every run.
//
// Outputs of up to 2500 elements that are not zero are compared whole at the first state, larger ones in two to eight of their
// columns; of matrices, every row times a vector is compared at each of the three states (two beyond 200 coordinates), so that
// no element goes untested. Expected numbers come from 50 digits; on robots of hundreds of joints, where those would take
// longer than the rest of the compiler, from long double.
//
// An element's tolerance is 512 epsilons of the scalar, or 10 times M's condition number of its unit roundoff where M is solved
// with, or four epsilons of the terms that cancel (LeastScale) in an output that all but vanishes, or 64 times the error of the
// generic engine in that scalar at the very state, whichever is largest: where a state or a robot is so ill-conditioned that
// any code must err, right code does not fail.
ir::SelfTest self_test(const ir::KinematicTree& tree, const ir::Scene& scene);

}  // namespace dalembert::reference
