// What must hold for the dynamics of any robot, computed without the algorithm under test.
//
// Every identity takes a result and says by how much it is violated, relative to the largest element involved; so the
// same functions judge right results and deliberately wrong ones. Derivatives are central differences in 100 digits with a
// step of 1e-30, good to about 1e-58. Driven joints are not supported here.
#pragma once

#include "multiprecision.hpp"

namespace dalembert::testing {

using Model = generic::Model<Multi>;
using Dynamics = generic::Dynamics<Multi>;
using Vector = VectorX<Multi>;
using Matrix = MatrixX<Multi>;

// One case: a robot in a state.
struct Case {
  Model model;
  Vector q, v;
};

// The configuration after moving with constant v for the time h: the base's pose is integrated on its manifold.
Vector integrate(const Model& model, const Vector& q, const Vector& v, const Multi& h);

// World poses of the base and of every body (index 0: the base), by composing angle-axis rotations.
std::vector<Transform<Multi>> world_poses(const Model& model, const Vector& q);

double mass_rate_error(const Case&, const Dynamics&);      // Ṁ = C + Cᵀ
double bias_error(const Case&, const Dynamics&);           // C v + g = Newton-Euler's bias
double mass_column_error(const Case&, const Dynamics&);    // M e_i = Newton-Euler of a unit acceleration
double symmetry_error(const Case&, const Dynamics&);       // M = Mᵀ
double definiteness_error(const Case&, const Dynamics&);   // 1 if M is not positive definite, else 0
double gravity_error(const Case&, const Dynamics&);        // g = gradient of the potential energy
double momentum_error(const Case&, const Dynamics&);       // base rows of M v: momentum of bodies moved by differences
double momentum_rate_error(const Case&, const Dynamics&);  // base rows of C v: rate of that momentum
double energy_error(const Case&, const Dynamics&);         // vᵀ M v / 2 = kinetic energy of bodies moved by differences
double influence_error(const Case&, const Dynamics&);      // W = transposed differences of body poses
double restatement_error(const Case&, const Dynamics&);    // C as restated in base axes with absolute velocities
double sparsity_error(const Case&, const Dynamics&);       // exact zeros where neither body is the other's ancestor

struct Identity {
  const char* name;
  double (*error)(const Case&, const Dynamics&);
};
inline constexpr Identity identities[] = {{"mass rate", mass_rate_error},
                                          {"bias", bias_error},
                                          {"mass columns", mass_column_error},
                                          {"symmetry", symmetry_error},
                                          {"definiteness", definiteness_error},
                                          {"gravity", gravity_error},
                                          {"momentum", momentum_error},
                                          {"momentum rate", momentum_rate_error},
                                          {"energy", energy_error},
                                          {"wrench influence", influence_error},
                                          {"restatement", restatement_error},
                                          {"sparsity", sparsity_error}};

}  // namespace dalembert::testing
