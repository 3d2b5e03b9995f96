// The same results of code for two and for eight lanes; see two_widths_test.sh.
#include <cmath>
#include <cstdio>
#include <random>

#include "wide_2/dynamics.hpp"
#include "wide_8/dynamics.hpp"

namespace {

bool good = true;

template <class A, class B>
void expect_same(const char* what, const A& a, const B& b) {
  const double error = (a - b).cwiseAbs().maxCoeff(), largest = a.cwiseAbs().maxCoeff();
  if (error <= 1e-9 * largest) return;  // a comparison that NaN does not pass
  std::printf("%s: %g of %g apart\n", what, error, largest);
  good = false;
}

}  // namespace

int main() {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> number(-1, 1);
  wide_2::VectorQ q;
  wide_2::VectorV v, more;
  for (double& x : q) x = number(random);
  q.segment<4>(3).normalize();
  for (double& x : v) x = number(random);
  for (double& x : more) x = number(random);
  const wide_8::VectorQ q8 = q.eval();
  const wide_8::VectorV v8 = v.eval(), more8 = more.eval();
  wide_2::Workspace two;
  wide_8::Workspace eight;
  wide_2::free(q, v, more, two), wide_8::free(q8, v8, more8, eight);
  wide_2::stand(q, v, more, two), wide_8::stand(q8, v8, more8, eight);
  wide_2::land(q, v, two), wide_8::land(q8, v8, eight);
  wide_2::bear(q, v, more, two), wide_8::bear(q8, v8, more8, eight);
  expect_same("forward dynamics", free_forward_dynamics(two), free_forward_dynamics(eight));
  expect_same("inverse mass matrix", free_inverse_mass_matrix(two), free_inverse_mass_matrix(eight));
  expect_same("accelerations", stand_constrained_forward_dynamics(two), stand_constrained_forward_dynamics(eight));
  expect_same("derivatives", stand_constrained_forward_dynamics_dq(two), stand_constrained_forward_dynamics_dq(eight));
  expect_same("impact", land_impact(two), land_impact(eight));
  expect_same("torques", bear_constrained_inverse_dynamics(two), bear_constrained_inverse_dynamics(eight));
  return good ? 0 : 1;
}
