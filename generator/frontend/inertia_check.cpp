#include "frontend/inertia_check.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>

namespace dalembert::frontend {

void check_inertia(const std::string& file, const std::string& element, const ir::Inertia& inertia, Diagnostics& errors,
                   Diagnostics& warnings) {
  if (inertia.inertia.isZero(0)) {
    if (inertia.mass > 0)
      warnings.push_back({Severity::warning, file, element, "the link has a mass but no rotational inertia: a point mass",
                          "give <inertia> if it has an extent"});
    return;
  }
  const Eigen::Vector3d moments =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia.inertia, Eigen::EigenvaluesOnly).eigenvalues();  // ascending
  const std::string principal =
      fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m²", moments[0], moments[1], moments[2]);
  const double rounding = 1e-12 * moments.cwiseAbs().maxCoeff();
  if (moments[0] < -rounding) {
    add_error(errors, {Severity::error, file, element, fmt::format("the inertia is not positive definite ({})", principal),
                       "correct <inertia>: its matrix about the centre of mass has no negative principal moment"});
    return;
  }
  const double excess = moments[2] - moments[0] - moments[1];
  if (excess > 1e-6 * moments[2])  // numbers in files are rounded: a plate has an excess of zero
    warnings.push_back({Severity::warning, file, element,
                        fmt::format("the inertia breaks the triangle inequality by {:.3g} kg m² ({})", excess, principal),
                        "no body has such an inertia: no principal moment exceeds the sum of the others; it is used as given"});
}

}  // namespace dalembert::frontend
