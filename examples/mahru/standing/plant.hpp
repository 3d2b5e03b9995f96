// MAHRU on a floor: MuJoCo simulates the same URDF, its base free, under gravity. Its feet and the floor are boxes; the ground
// acts at the corners of the soles, by friction inside of the round cone. Nothing of dalembert is in here.
#pragma once

#include "../controller/plant.hpp"
#include "types.hpp"

namespace standing {

class Plant : public controller::Plant {
 public:
  // friction: the floor's, of Coulomb's law. Throws std::runtime_error when MuJoCo refuses the model.
  Plant(const std::string& urdf_file, const char* const* joint_names, double friction);

  const VectorJ& limits() const { return limits_; }  // of torques, N m

  // None of these allocates.
  void push(const Vector3d& force) noexcept;  // N, world axes, at the torso's centre of mass, until it is called again
  // The ground's on the left and the right sole, as last stepped. z is up, as the floor's cone of friction is, whatever a foot
  // tilts while it comes down.
  void ground(Vector12& forces) const noexcept;

 private:
  VectorJ limits_;
  int torso_;
  std::array<int, 2> foot_geom_;
};

}  // namespace standing
