/* The C side: what is generated can be called from C, or from anything that calls C. */
#include "cart_pole/c_api.h"

#include <math.h>
#include <stdio.h>

/* Compares with the formulas of any textbook; 0 when they agree. */
int try_cart_pole(void) {
  const double mass = 3, pole_mass = 1, length = 0.5, inertia = 0.08, g0 = 9.81;
  const double q[2] = {0.3, 0.7}, v[2] = {0, 0};
  const double cross = pole_mass * length * cos(q[1]);
  const double expected_M[4] = {mass + pole_mass, cross, cross, inertia + pole_mass * length * length};
  const double expected_g[2] = {0, -pole_mass * g0 * length * sin(q[1])};
  double error = 0;
  int i;
  const double *M, *g;

  cart_pole_workspace* workspace = cart_pole_create();
  cart_pole_evaluate(q, v, workspace);
  M = cart_pole_mass_matrix(workspace);
  g = cart_pole_gravity(workspace);
  for (i = 0; i < 4; ++i) error = fmax(error, fabs(M[i] - expected_M[i]));
  for (i = 0; i < 2; ++i) error = fmax(error, fabs(g[i] - expected_g[i]));
  printf("cart_pole, in C: mass on the rail %g kg, differs from the textbook by %.1e\n", M[0], error);
  cart_pole_destroy(workspace);
  return error < 1e-12 ? 0 : 1;
}
