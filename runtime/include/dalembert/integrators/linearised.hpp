// The equations of motion near a state: what implicit methods solve with.
#pragma once

#include <Eigen/Core>

namespace dalembert::integrators {

// mass · v̇ = force, where near the state force changes by −damping · δv − stiffness · δq (δq along v's coordinates). Neither
// needs to be exact: they decide how large a step may be and how fast iterations converge. C + D, D being the dampers',
// is a good damping, the springs' constants a good stiffness.
template <class Scalar, int nv>
struct Linearised {
  Eigen::Matrix<Scalar, nv, nv> mass, damping, stiffness;
  Eigen::Matrix<Scalar, nv, 1> force;  // τ − C v − g, and what springs and dampers add
};

}  // namespace dalembert::integrators
