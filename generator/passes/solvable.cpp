#include "passes/solvable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "passes/joints_without_mass.hpp"

namespace dalembert::passes {

void check_solvable(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::Scene& scene) {
  for (const ir::Quantity quantity : scene.quantities()) {
    const ir::QuantityRow& row = ir::row_of(quantity);
    if (row.scale != ir::Scale::solved) continue;
    std::vector<std::string> driven, massless;
    for (const ir::Body& body : tree.bodies)
      if (body.driven()) driven.push_back(body.joint);
    for (const int joint : joints_without_mass(tree, scene))
      massless.push_back(in_words(tree.bodies[static_cast<size_t>(joint)]));
    if (!massless.empty())
      throw InputError({Severity::error, robot.file, fmt::format("joint {}", fmt::join(massless, ", ")),
                        fmt::format("moves no mass: the mass matrix is singular, and there is no {}", row.name),
                        "give the links beyond it <inertial>, the joint an armature, or lock it (massless: lock)"});
    const bool derivative = quantity == ir::Quantity::forward_dynamics_dq || quantity == ir::Quantity::forward_dynamics_dv;
    if (!driven.empty() && derivative)
      throw InputError(
          {Severity::error, robot.file, fmt::format("joint '{}'", fmt::join(driven, "', '")),
           fmt::format("is driven by another: {} starts from articulated bodies, joint by joint", row.name),
           "ask for forward_dynamics and inverse_mass_matrix, and for inverse_dynamics_dq and inverse_dynamics_dv at "
           "the accelerations found, or lock it, or leave the mimic relation out"});
  }
}

}  // namespace dalembert::passes
