// Where the numbers of a joint with a unit quaternion stand: a spherical one, or a floating one in the tree.
#pragma once

namespace dalembert {

// In q, from `q` on: the quaternion x y z w, before it the position (m) where the joint slides. In v, from `v` on: the angular
// velocity along the child's axes, before it the linear one where the joint slides.
struct QuaternionJoint {
  int q, v;
  bool slides;
};

}  // namespace dalembert
