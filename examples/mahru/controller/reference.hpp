// The motion to follow: every joint its own sinusoid, faded in smoothly over the first second.
//
//     q_d(t) = r(t) (c + a sin(ω t + φ)),   r rising from 0 to 1 with continuous second derivative
//
// Centre c and amplitude a keep each joint inside its limits; frequencies and phases differ from joint to joint, so that no
// two move alike and all coupling terms of M and C are in play.
#pragma once

#include "types.hpp"

namespace controller {

class Reference {
 public:
  Reference(const VectorJ& lower, const VectorJ& upper);  // joint limits, rad
  void at(double t, Target& target) const noexcept;       // t in s since the start

 private:
  VectorJ centre_, amplitude_, frequency_, phase_;  // rad, rad, rad/s, rad
};

}  // namespace controller
