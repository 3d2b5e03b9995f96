// Integrators on the robot: error against time (work and precision), and joints stiffer than the step.
#pragma once

#include <memory>
#include <string>

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"

namespace dalembert::reporting {

class Simulated;

class Integration {
 public:
  explicit Integration(const Subject& subject);
  ~Integration();

  // What takes time and may run beside other work: generated M, C and bias in double.
  void compile();

  // Rows of section `integration`, by that code and a factorisation of M.
  //
  // Case `free motion, step H ms`: a fifth of a second from a random state without forces but the scene's own. Per integrator
  // the error of q and v against a trajectory in extended precision by another program, time of computing per second of motion,
  // drift of energy. Case `free motion`: the order seen. Cases `springs of K`: a second at 1 ms with springs of K N m/rad (N/m)
  // in all joints that pull back to where they started: the largest speed met, and whether it stayed bounded.
  //
  // A row `not_simulated` says why there is nothing of this, or no free motion: where the scene's motion has no smooth solution
  // to compare with.
  void add(Rows& rows) const;

 private:
  const Subject& subject_;
  std::string why_not_;
  std::unique_ptr<Simulated> simulated_;
};

}  // namespace dalembert::reporting
