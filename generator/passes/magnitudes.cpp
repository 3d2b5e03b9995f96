#include "passes/magnitudes.hpp"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>

#include "diagnostics.hpp"

namespace dalembert::passes {

namespace {

bool in_range(double number) { return std::abs(number) <= largest_number; }  // NaN is not

template <class Matrix>
bool all_in_range(const Matrix& matrix) {
  return matrix.unaryExpr([](double number) { return in_range(number); }).all();
}

bool in_range(const ir::Inertia& inertia) {
  return in_range(inertia.mass) && all_in_range(inertia.com) && all_in_range(inertia.inertia);
}

bool in_range(const ir::Body& body) {
  for (const double number :
       {body.armature, body.damping, body.friction, body.multiplier, body.offset, body.spring.k, body.spring.rest})
    if (!in_range(number)) return false;
  return in_range(body.inertia) && all_in_range(body.placement.matrix());
}

}  // namespace

void check_magnitudes(const ir::KinematicTree& tree, const std::string& file) {
  Diagnostics errors;
  const auto refuse = [&](std::string element) {
    add_error(errors, {Severity::error, file, std::move(element),
                       fmt::format("a length, mass or other number is larger than {}", largest_number),
                       "check the numbers of the URDF and the scene: lengths are m, masses kg"});
  };
  if (!in_range(tree.base)) refuse(fmt::format("link '{}'", tree.base_link));
  for (const ir::Body& body : tree.bodies)
    if (!in_range(body)) refuse(fmt::format("joint '{}' and link '{}'", body.joint, body.name));
  for (const ir::LinkPlacement& link : tree.links)
    if (!all_in_range(link.placement.matrix())) refuse(fmt::format("link '{}'", link.link));
  if (!errors.empty()) throw InputError(errors);
}

}  // namespace dalembert::passes
