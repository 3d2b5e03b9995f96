// Energy, centre of mass and momentum of all that moves, in any scalar. Links welded to a fixed base are no part of it; a robot
// without mass has no centre: NaN. Layouts, errors and costs as in dynamics.hpp.
#pragma once

#include <dalembert/generic/centroidal.hpp>
#include <dalembert/generic/dynamics.hpp>
#include <dalembert/generic/energy.hpp>

namespace dalembert::generic {

template <class S>
struct WholeRobot {
  S kinetic_energy;                    // ½ vᵀ M v, armature included, J
  S potential_energy;                  // zero with the centre of mass in the world's origin and springs at rest, J
  Vector3<S> center_of_mass;           // in the world, m
  MatrixX<S> center_of_mass_jacobian;  // 3 × nv: the centre's velocity, world axes, is J v
  MatrixX<S> momentum_matrix;          // A, 6 × nv: momentum about the centre of mass, world axes, linear part first, is A v
  Vector6<S> momentum_bias;            // Ȧ v: the momentum's rate is A v̇ + Ȧ v
  Vector3<S> center_of_mass_bias;      // J̇ v: the centre's acceleration, world axes, is J v̇ + J̇ v
};

template <class S>
WholeRobot<S> whole_robot(const Model<S>& model, In<S> q, In<S> v) {
  check_size<S>(q, model.nq(), "q");
  check_size<S>(v, model.nv(), "v");
  const Reduction<S> reduction(model);
  const VectorX<S> positions = reduction.expand_position(q), rates = reduction.expand_velocity(v);
  const Kinematics<S> kinematics = phase1<S>(model, positions, rates);
  return {expanded_kinetic_energy<S>(model, kinematics, rates),
          potential_energy<S>(model, kinematics, positions),
          center_of_mass<S>(model, kinematics, positions),
          reduction.reduce_columns(expanded_center_of_mass_jacobian<S>(model, kinematics, positions)),
          reduction.reduce_columns(expanded_momentum_matrix<S>(model, kinematics, phase2(model, kinematics), positions)),
          expanded_momentum_bias<S>(model, kinematics, positions, rates),
          expanded_center_of_mass_bias<S>(model, kinematics, positions, rates)};
}

}  // namespace dalembert::generic
