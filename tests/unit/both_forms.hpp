// Every output of a scene by both forms of its algorithms, interpreted in double, against the generic engine. No code is
// compiled.
#pragma once

#include <array>
#include <optional>
#include <robots.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "commands/output.hpp"
#include "commands/state_file.hpp"
#include "interpret.hpp"
#include "ir/emitted_function.hpp"
#include "ir/robot_description.hpp"
#include "pipeline.hpp"

namespace dalembert {

using Payload = std::array<double, 10>;  // mass, centre of mass, inertia xx xy xz yy yz zz
inline constexpr Payload tool{1.7, 0.03, -0.02, 0.11, 0.02, 0.003, -0.001, 0.03, 0.002, 0.025};

ir::RobotDescription robot(std::string_view name);
Model model_of(const ir::RobotDescription& description, const ir::Scene& scene);
State some_state(const ir::KinematicTree& tree);
std::string link_moved_by(const ir::RobotDescription& robot, const std::string& name);

// On the last body that moves, and, where there are enough, on two above or beside it: a weld and points, along the world's
// axes and a link's.
std::vector<ir::Contact> some_contacts(const ir::RobotDescription& robot);

// Between links of different limbs, or of one: what closes a linkage. Some are redundant, and none is closed.
std::vector<ir::Loop> some_loops(const ir::RobotDescription& robot);

// The payload welded to the link.
ir::KinematicTree welded(ir::KinematicTree tree, const std::string& link, const Payload& payload);

// Of every constraint, as a new workspace has them.
struct Gains {
  double kp = 0, kd = 0, anchor[7] = {0, 0, 0, 0, 0, 0, 1};
};

// Where loops are embedded: T and T' of the independent coordinates (dalembert/linkage.hpp), dense.
struct Following {
  Eigen::MatrixXd T, T_rate;
  LinkageStatus<double> status;
};
Following following(const ir::KinematicTree& tree, const State& state);

// The results of a function in both forms: sections take what those before have left in their form.
std::array<ir::Arrays, 2> run_function(const ir::EmittedFunction& function, const Model& model, const State& state,
                                       const Payload& payload, const Gains& gains = {}, std::optional<ir::Solver> solver = {});

// The results of every function of the scene, in both forms.
std::array<ir::Arrays, 2> run_both(const Model& model, const State& state, const Payload& payload);

// Every output of the scene, in both forms, with `payload` at each link that carries one. slack: how many times what rounding
// is otherwise allowed.
void expect_generic_values(const Model& model, const Payload& payload = {}, double slack = 1, const ir::Acting& acting = {});

}  // namespace dalembert
