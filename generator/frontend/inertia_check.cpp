#include "frontend/inertia_check.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <vector>

namespace dalembert::frontend {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr const char* go_on = "or go on knowingly with inertia: accept or inertia: repair in the scene";

std::string principal(const Vector3d& moments) {
  return fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m²", moments[0] + 0.0, moments[1] + 0.0, moments[2] + 0.0);
}

class InertiaCheck {
 public:
  InertiaCheck(ir::RobotDescription& robot, const ir::Scene& scene, Diagnostics& warnings)
      : robot_(robot), scene_(scene), warnings_(warnings) {}

  void run() {
    const std::vector<ir::Link*> links = moving_links();
    for (const ir::Link* link : links) largest_ = std::max(largest_, moments(*link->inertia).cwiseAbs().maxCoeff());
    for (ir::Link* link : links) check(*link);
    if (!errors_.empty()) throw InputError(errors_);
  }

 private:
  // Links with an inertia that takes part in the motion.
  std::vector<ir::Link*> moving_links() {
    struct Visit {
      int link;
      bool moves;
    };
    std::vector<ir::Link*> links;
    std::vector<Visit> rest{{robot_.root, scene_.base == ir::Base::floating}};
    while (!rest.empty()) {
      const Visit visit = rest.back();
      rest.pop_back();
      ir::Link& link = robot_.links[static_cast<size_t>(visit.link)];
      if (link.inertia && visit.moves) links.push_back(&link);
      for (int j : robot_.children[static_cast<size_t>(visit.link)]) {
        const ir::Joint& joint = robot_.joints[static_cast<size_t>(j)];
        const bool moves = joint.type != ir::JointType::fixed && !scene_.locked.count(joint.name);
        if (!scene_.cut.count(robot_.links[static_cast<size_t>(joint.child)].name))
          rest.push_back({joint.child, visit.moves || moves});
      }
    }
    std::sort(links.begin(), links.end());  // the file's order
    return links;
  }

  static Vector3d moments(const ir::Inertia& inertia) {  // ascending
    return Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia.inertia, Eigen::EigenvaluesOnly).eigenvalues();
  }

  void check(ir::Link& link) {
    const ir::Inertia& inertia = *link.inertia;
    if (inertia.mass < 0) {
      const std::string message = fmt::format("the mass is negative ({} kg)", inertia.mass);
      if (scene_.inertia == ir::InertiaPolicy::accept)
        warn(link, message + " and used as given, as the scene says", "", "negative mass");
      else error(link, message, "give the link a mass of zero or more, or go on knowingly with inertia: accept in the scene");
    }
    if (inertia.inertia.isZero(0)) {
      if (inertia.mass > 0)
        warn(link, "the link has a mass but no rotational inertia: a point mass", "give <inertia> if it has an extent", "");
      return;
    }
    const Vector3d moments = this->moments(inertia);
    if (scene_.inertia == ir::InertiaPolicy::repair) return repair(link);
    if (const double most = moments.cwiseAbs().maxCoeff(); moments[0] < -1e-12 * most) {
      if (moments[0] >= -std::max(1e-5 * most, 1e-12 * largest_))
        return warn(link,
                    fmt::format("a principal moment is negative by rounding ({}); it is used as given", principal(moments)),
                    "write <inertia> with more digits", "negative by rounding");
      const std::string message = fmt::format("the inertia is not positive definite ({})", principal(moments));
      if (scene_.inertia == ir::InertiaPolicy::refuse)
        return error(
            link, message,
            fmt::format("correct <inertia>: its matrix about the centre of mass has no negative principal moment; {}", go_on));
      return warn(link, message + " and used as given, as the scene says", "correct <inertia>", "negative");
    }
    const double excess = moments[2] - moments[0] - moments[1];
    if (excess > 1e-6 * moments[2])  // numbers in files are rounded: a plate has an excess of zero
      warn(link, fmt::format("the inertia breaks the triangle inequality by {:.3g} kg m² ({})", excess, principal(moments)),
           "no body has such an inertia: no principal moment exceeds the sum of the others; it is used as given", "triangle");
  }

  // Second moments Σ = tr(I)/2 − I; the inverse is I = tr(Σ) − Σ.
  void repair(ir::Link& link) {
    Matrix3d& inertia = link.inertia->inertia;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> principal_axes(0.5 * inertia.trace() * Matrix3d::Identity() - inertia);
    const Vector3d second = principal_axes.eigenvalues();
    if (second[0] >= -1e-12 * second.cwiseAbs().maxCoeff()) return;
    const Vector3d kept = second.cwiseMax(0);
    const Vector3d before = moments(*link.inertia);
    const Matrix3d axes = principal_axes.eigenvectors();
    const Vector3d repaired = kept.sum() * Vector3d::Ones() - kept;
    inertia = axes * repaired.asDiagonal() * axes.transpose();
    inertia = (0.5 * (inertia + inertia.transpose())).eval();
    warn(link,
         fmt::format("the inertia is no body's ({}) and repaired, as the scene says ({})", principal(before),
                     principal(moments(*link.inertia))),
         "correct <inertia>", "repaired");
  }

  std::string place(const ir::Link& link) const { return fmt::format("link '{}' (line {})", link.name, link.line); }
  void error(const ir::Link& link, std::string message, std::string remedy) {
    add_error(errors_, {Severity::error, robot_.file, place(link), std::move(message), std::move(remedy)});
  }
  void warn(const ir::Link& link, std::string message, std::string remedy, std::string kind) {
    warnings_.push_back({Severity::warning, robot_.file, place(link), std::move(message), std::move(remedy), std::move(kind)});
  }

  ir::RobotDescription& robot_;
  const ir::Scene& scene_;
  Diagnostics& warnings_;
  Diagnostics errors_;
  double largest_ = 0;  // principal moment of the robot, kg m²
};

}  // namespace

void check_inertias(ir::RobotDescription& robot, const ir::Scene& scene, Diagnostics& warnings) {
  InertiaCheck(robot, scene, warnings).run();
}

}  // namespace dalembert::frontend
