#include "passes/inertia_check.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <string>
#include <unordered_map>
#include <vector>

namespace dalembert::passes {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr const char* go_on = "or go on knowingly with inertia: accept or inertia: repair in the scene";

std::string principal(const Vector3d& moments) {
  return fmt::format("principal moments {:.6g}, {:.6g}, {:.6g} kg m²", moments[0] + 0.0, moments[1] + 0.0, moments[2] + 0.0);
}

Vector3d moments_of(const ir::Inertia& inertia) {  // ascending
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(inertia.inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

enum class Fault { none, triangle, rounding, negative };

// What is wrong with an inertia, in words that are followed by what becomes of it.
struct Judgement {
  Fault fault = Fault::none;
  std::string words = {};
};

std::string some(const std::vector<std::string>& places) {
  constexpr size_t most = 5;
  std::string text =
      fmt::format("{}", fmt::join(places.begin(), places.begin() + std::ptrdiff_t(std::min(places.size(), most)), ", "));
  return places.size() > most ? fmt::format("{} and {} more", text, places.size() - most) : text;
}

std::string place(const ir::Link& link) { return fmt::format("link '{}' (line {})", link.name, link.line); }

class InertiaCheck {
 public:
  InertiaCheck(const ir::RobotDescription& robot, const ir::Scene& scene, ir::KinematicTree& tree, Diagnostics& warnings)
      : robot_(robot), scene_(scene), tree_(tree), warnings_(warnings) {}

  void run() {
    const std::vector<std::vector<const ir::Link*>> parts = links_of_bodies();
    const auto inertia_of = [&](size_t i) -> ir::Inertia& { return i == 0 ? tree_.base : tree_.bodies[i - 1].inertia; };
    for (size_t i = 0; i < parts.size(); ++i)
      if (!parts[i].empty()) largest_ = std::max(largest_, moments_of(inertia_of(i)).cwiseAbs().maxCoeff());
    for (size_t i = 0; i < parts.size(); ++i)
      if (parts[i].size() == 1) check_alone(inertia_of(i), place(*parts[i].front()));
      else if (!parts[i].empty()) check_welded(inertia_of(i), i == 0 ? tree_.base_link : tree_.bodies[i - 1].name, parts[i]);
    if (!errors_.empty()) throw InputError(errors_);
  }

 private:
  // Per body, the base's first: its links with an inertia, in the file's order. None of a base that does not move.
  std::vector<std::vector<const ir::Link*>> links_of_bodies() const {
    std::unordered_map<std::string, int> body_of;
    for (const ir::LinkPlacement& link : tree_.links)
      if (link.body >= 0 || tree_.base_coordinates() > 0) body_of.emplace(link.link, link.body);
    std::vector<std::vector<const ir::Link*>> links(tree_.bodies.size() + 1);
    for (const ir::Link& link : robot_.links)
      if (const auto body = body_of.find(link.name); link.inertia && body != body_of.end())
        links[static_cast<size_t>(body->second + 1)].push_back(&link);
    return links;
  }

  Judgement judge(const ir::Inertia& inertia) const {
    const Vector3d moments = moments_of(inertia);
    if (const double most = moments.cwiseAbs().maxCoeff(); moments[0] < -1e-12 * most) {
      if (moments[0] >= -std::max(1e-5 * most, 1e-12 * largest_))
        return {Fault::rounding, fmt::format("a principal moment is negative by rounding ({})", principal(moments))};
      return {Fault::negative, fmt::format("the inertia is not positive definite ({})", principal(moments))};
    }
    const double excess = moments[2] - moments[0] - moments[1];
    if (excess > 1e-6 * moments[2])  // numbers in files are rounded: a plate has an excess of zero
      return {Fault::triangle,
              fmt::format("the inertia breaks the triangle inequality by {:.3g} kg m² ({})", excess, principal(moments))};
    return {};
  }

  void check_alone(ir::Inertia& inertia, const std::string& place) {
    check(inertia, place, "");
    warn_of_point_mass(inertia, place);
  }

  // A body, `because` of some of its links. Whether nothing is wrong with it.
  bool check(ir::Inertia& inertia, const std::string& place, const std::string& because) {
    const bool mass_is_sound = check_mass(inertia, place, because);
    if (inertia.inertia.isZero(0)) return mass_is_sound;
    if (scene_.inertia == ir::InertiaPolicy::repair) return repair(inertia, place, because) && mass_is_sound;
    const Judgement judgement = judge(inertia);
    const std::string words = judgement.words + because;
    switch (judgement.fault) {
      case Fault::none: return mass_is_sound;
      case Fault::rounding:
        warn(place, words + "; it is used as given", "write <inertia> with more digits", "negative by rounding");
        break;
      case Fault::triangle:
        warn(place, words,
             "no body has such an inertia: no principal moment exceeds the sum of the others; it is used as given", "triangle");
        break;
      case Fault::negative:
        if (scene_.inertia == ir::InertiaPolicy::accept)
          warn(place, words + " and used as given, as the scene says", "correct <inertia>", "negative");
        else
          error(place, words,
                fmt::format("correct <inertia>: its matrix about the centre of mass has no negative principal moment; {}",
                            go_on));
    }
    return false;
  }

  bool check_mass(const ir::Inertia& inertia, const std::string& place, const std::string& because) {
    if (inertia.mass >= 0) return true;
    const std::string words = fmt::format("the mass is negative ({} kg){}", inertia.mass, because);
    if (scene_.inertia == ir::InertiaPolicy::accept)
      warn(place, words + " and used as given, as the scene says", "", "negative mass");
    else error(place, words, "give the link a mass of zero or more, or go on knowingly with inertia: accept in the scene");
    return false;
  }

  void check_welded(ir::Inertia& inertia, const std::string& body, const std::vector<const ir::Link*>& links) {
    const std::string element = fmt::format("body '{}'", body);
    std::vector<std::string> at_fault;
    bool any_mass = false;
    for (const ir::Link* link : links) {
      any_mass = any_mass || link->inertia->mass != 0;
      if (link->inertia->mass < 0 || judge(*link->inertia).fault != Fault::none) at_fault.push_back(place(*link));
    }
    if (any_mass && inertia.mass == 0)
      return error(element, "the masses of its links cancel: there is no centre of mass; negative is that of " + some(at_fault),
                   "give these links a mass of zero or more");
    if (!check(inertia, element, " with all its links welded together, by fault of " + some(at_fault))) return;
    const std::string all_the_same =
        fmt::format("; that of body '{}', which the link is welded into, is sound: it is used as given", body);
    for (const ir::Link* link : links) {
      const ir::Inertia& own = *link->inertia;
      warn_of_point_mass(own, place(*link));
      if (own.mass < 0)
        warn(place(*link), fmt::format("the mass is negative ({} kg)", own.mass) + all_the_same,
             "give the link a mass of zero or more", "negative mass in a sound body");
      if (const Judgement judgement = judge(own); judgement.fault != Fault::none)
        warn(place(*link), judgement.words + all_the_same, "correct <inertia>",
             judgement.fault == Fault::negative ? "negative in a sound body" : "odd in a sound body");
    }
  }

  // Second moments Σ = tr(I)/2 − I; the inverse is I = tr(Σ) − Σ. Whether there was nothing to do.
  bool repair(ir::Inertia& body, const std::string& place, const std::string& because) {
    Matrix3d& inertia = body.inertia;
    const Eigen::SelfAdjointEigenSolver<Matrix3d> principal_axes(0.5 * inertia.trace() * Matrix3d::Identity() - inertia);
    const Vector3d second = principal_axes.eigenvalues();
    if (second[0] >= -1e-12 * second.cwiseAbs().maxCoeff()) return true;
    const Vector3d kept = second.cwiseMax(0);
    const Vector3d before = moments_of(body);
    const Matrix3d axes = principal_axes.eigenvectors();
    const Vector3d repaired = kept.sum() * Vector3d::Ones() - kept;
    inertia = axes * repaired.asDiagonal() * axes.transpose();
    inertia = (0.5 * (inertia + inertia.transpose())).eval();
    warn(place,
         fmt::format("the inertia is no body's ({}){} and repaired, as the scene says ({})", principal(before), because,
                     principal(moments_of(body))),
         "correct <inertia>", "repaired");
    return false;
  }

  void warn_of_point_mass(const ir::Inertia& inertia, const std::string& place) {
    if (inertia.mass <= 0 || !inertia.inertia.isZero(0)) return;
    warn(place, "the link has a mass but no rotational inertia: a point mass", "give <inertia> if it has an extent", "");
  }
  void error(std::string element, std::string message, std::string remedy) {
    add_error(errors_, {Severity::error, robot_.file, std::move(element), std::move(message), std::move(remedy)});
  }
  void warn(std::string element, std::string message, std::string remedy, std::string kind) {
    warnings_.push_back(
        {Severity::warning, robot_.file, std::move(element), std::move(message), std::move(remedy), std::move(kind)});
  }

  const ir::RobotDescription& robot_;
  const ir::Scene& scene_;
  ir::KinematicTree& tree_;
  Diagnostics& warnings_;
  Diagnostics errors_;
  double largest_ = 0;  // principal moment of a body, kg m²
};

}  // namespace

void check_inertias(const ir::RobotDescription& robot, const ir::Scene& scene, ir::KinematicTree& tree, Diagnostics& warnings) {
  InertiaCheck(robot, scene, tree, warnings).run();
}

}  // namespace dalembert::passes
