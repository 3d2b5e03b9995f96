#include "passes/magnitudes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>

#include "diagnostics.hpp"
#include "ir/magnitudes.hpp"

namespace dalembert::passes {

namespace {

struct Range {
  double largest;

  bool holds(double number) const { return std::abs(number) <= largest; }  // NaN is not
  template <class Derived>
  bool holds(const Eigen::MatrixBase<Derived>& matrix) const {
    return matrix.unaryExpr([this](double number) { return holds(number); }).all();
  }
  bool holds(const ir::Inertia& inertia) const { return holds(inertia.mass) && holds(inertia.com) && holds(inertia.inertia); }
  bool holds(const ir::Body& body) const {
    for (const double number : {body.armature, body.damping, body.friction, body.multiplier, body.offset, body.spring.k,
                                body.spring.rest, body.pitch})
      if (!holds(number)) return false;
    return holds(body.inertia) && holds(body.placement.matrix());
  }
  bool holds(const ir::Loop& loop) const {
    return holds(loop.at[0].matrix()) && holds(loop.at[1].matrix()) && holds(loop.length.value_or(0));
  }
};

}  // namespace

void check_magnitudes(const ir::KinematicTree& tree, const ir::Scene& scene, const std::string& file) {
  const Range range{ir::largest_of(scene.scalar)};
  Diagnostics errors;
  const auto refuse = [&](std::string element, const std::string& where) {
    add_error(errors, {Severity::error, where, std::move(element),
                       fmt::format("a length, mass or other number is larger than {}", ir::largest_in_words(scene.scalar)),
                       "check the numbers of the URDF and the scene: lengths are m, masses kg"});
  };
  if (!range.holds(tree.base)) refuse(fmt::format("link '{}'", tree.base_link), file);
  for (const ir::Body& body : tree.bodies)
    if (!range.holds(body)) refuse(fmt::format("joint '{}' and link '{}'", body.joint, body.name), file);
  for (const ir::LinkPlacement& link : tree.links)
    if (!range.holds(link.placement.matrix())) refuse(link.in_words(), link.on.empty() ? file : "");
  for (const std::vector<ir::Loop>* loops : {&scene.loops, &scene.embedded})
    for (const ir::Loop& loop : *loops)
      if (!range.holds(loop)) refuse(fmt::format("loop '{}'", loop.name), file);
  if (!range.holds(scene.gravity)) refuse("scene key 'gravity'", "");
  if (!errors.empty()) throw InputError(errors);
}

}  // namespace dalembert::passes
