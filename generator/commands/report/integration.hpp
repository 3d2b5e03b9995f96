// Integrators on the robot: error against time (work and precision), and joints stiffer than the step.
#pragma once

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"

namespace dalembert::reporting {

// Rows of section `integration`, by generated M, C and bias in double and a factorisation of M.
//
// Case `free motion, step H ms`: a fifth of a second from a random state without forces but the scene's own. Per integrator the
// error of q and v against a trajectory in extended precision by another program, time of computing per second of motion, drift
// of energy. Case `free motion`: the order seen. Cases `springs of K`: a second at 1 ms with springs of K N m/rad (N/m) in all
// joints that pull back to where they started: the largest speed met, and whether it stayed bounded.
//
// A single row `not_simulated` says why where the scene's motion has no smooth solution to compare with.
void add_integration(const Subject& subject, Rows& rows);

}  // namespace dalembert::reporting
