#include "passes/solvable.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "passes/joints_without_mass.hpp"

namespace dalembert::passes {

void check_solvable(const ir::RobotDescription& robot, const ir::KinematicTree& tree, const ir::Scene& scene) {
  for (const ir::Quantity quantity : scene.quantities()) {
    const ir::QuantityRow& row = ir::row_of(quantity);
    if (row.scale != ir::Scale::solved) continue;
    std::vector<std::string> massless;
    for (const int joint : joints_without_mass(tree, scene))
      massless.push_back(in_words(tree.bodies[static_cast<size_t>(joint)]));
    if (!massless.empty())
      throw InputError({Severity::error, robot.file, fmt::format("joint {}", fmt::join(massless, ", ")),
                        fmt::format("moves no mass: the mass matrix is singular, and there is no {}", row.name),
                        "give the links beyond it <inertial>, the joint an armature, or lock it (massless: lock)"});
  }
}

}  // namespace dalembert::passes
