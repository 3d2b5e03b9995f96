#include "commands/options.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "commands/calibrate.hpp"
#include "ir/quantity.hpp"

namespace dalembert {

namespace {
struct Help {
  const char* key;
  const char* value;
  const char* text;
};

// Without a text: what the registry says.
constexpr Help scene_help[] = {
    {"base", "fixed|floating", "default: floating, unless the root link is called world or has no inertia"},
    {"gravity", "X,Y,Z|none|run_time",
     "m/s² along the world's axes, default 0,0,-9.81; run_time=X,Y,Z sets the value to start with"},
    {"outputs", "A,B,...", nullptr},
    {"functions", "NAME=A,B,...", "further functions, each of these quantities, in one call that shares what they share"},
    {"coriolis", "balance|christoffel", "which C, of those with dM/dt = C + C': of dynamical balance (default) or Christoffel"},
    {"forward_dynamics", "articulated_bodies|factorization",
     "how equations with M are solved; default: whichever is estimated to be faster"},
    {"locked", "JOINT=VALUE,...", "joints held at a value (rad or m)"},
    {"cut", "LINK,...", "links removed, with their descendants"},
    {"joints", "{JOINT: {helical: M_PER_TURN}|{universal: [X, Y, Z]}|planar|spherical|floating}",
     "what joints are that the URDF calls otherwise: a screw, two axes through one point, a plane, a ball, free"},
    {"mimic", "urdf|{JOINT: {of: JOINT, multiplier: 1, offset: 0}}", "mimic joints: each follows another"},
    {"jacobians", "LINK,...", "links whose body Jacobian is an output too"},
    {"frames",
     "LINK,...|{LINK: [QUANTITY, ...], NAME: {link: LINK, at: [X, Y, Z, ROLL, PITCH, YAW], outputs: [QUANTITY, ...]}}",
     "links, and frames of your own on links, whose pose, twist, Jacobian and bias acceleration are outputs too"},
    {"payloads", "LINK,...", "links that carry a payload given at run time"},
    {"wrenches", "LINK,...|LINK=link|world,...",
     "links with an external force and moment given at run time, along their axes or the world's"},
    {"contacts", "LINK=weld|point,...|{NAME: {link: LINK, type: weld, at: [X, Y, Z], axes: world}}",
     "where the world holds links, all six ways or at a point; rows of constraint_jacobian, in this order"},
    {"loops", "{NAME: {links: [A, B], at: [[X, Y, Z, R, P, Y], [...]], type: hinge}}",
     "which links hold each other: point, weld, hinge, cylinder, planar, pin or distance; rows behind those of contacts"},
    {"passive", "JOINT,...", "joints without a motor: constrained_inverse_dynamics leaves them no torque"},
    {"armature", "JOINT=VALUE,...", "rotor inertia at the joint, kg m² or kg"},
    {"damping", "urdf|JOINT=VALUE,...", "viscous damping, N m s/rad or N s/m"},
    {"friction", "urdf|JOINT=VALUE,...", "Coulomb friction, N m or N"},
    {"stiffness", "JOINT=K,...|{JOINT: {k: K, rest: Q}}", "springs: k (q - rest), N m/rad or N/m, and rad or m"},
    {"elastic", "{JOINT: {k: K, inertia: B, damping: D}}",
     "joints whose motor, of this inertia (kg m² or kg), moves the link through a spring: two coordinates each"},
    {"massless", "keep|lock", "joints that move no mass: left as they are, with a warning (default), or locked"},
    {"inertia", "refuse|accept|repair", "inertias that no body has: refused (default), used as given, or made the nearest one"},
    {"rates_zero", "true|false", "statics: all velocities are zero"},
    {"scalar", "double|float", "number type of the generated code, default double"},
    {"parallel", "serial|tasks|auto", "whether a task graph is generated beside the serial code, default auto"},
    {"plan", "measure|{FUNCTION: {form: F, solver: S, order: O}}",
     "how functions are computed; default: as is estimated to be fastest. 'measure' (generate, info) compiles the ways and "
     "times "
     "them here, and writes the fastest into the scene file"},
    {"batch", "true|false", "functions that take many states at once are generated too"},
    {"rollouts", "linearly_implicit|impacts", "what batches' rollouts know besides: stiff joints, contacts that come on"},
};

// Those of ir/quantities.def.
std::string outputs_help() {
  std::vector<std::string> all, usual;
  for (const ir::QuantityRow& row : ir::quantities()) {
    all.emplace_back(row.name);
    if (row.by_default) usual.emplace_back(row.name);
  }
  return fmt::format("{}; default: {}", fmt::join(all, ", "), fmt::join(usual, ", "));
}

}  // namespace

SharedOptions::SharedOptions(CLI::App& command) {
  command
      .add_option("ROBOT", request_.robot, "URDF file; a .xacro is expanded by the program xacro, a .sdf read by libsdformat")
      ->required()
      ->type_name("FILE");
  command.add_option("--scene", request_.scene_file, "scene file (YAML); keys that are given as options, too, override it")
      ->type_name("FILE");
  command.add_option("--name", request_.name, "namespace of the generated code, default: the robot's name")->type_name("NAME");
  command
      .add_option("--form", request_.form,
                  "shape of the code: one straight line, or loops over branches in lanes; default auto")
      ->check(CLI::IsMember({"auto", "straight", "rolled"}))
      ->type_name("auto|straight|rolled");
  command.add_option("--without", request_.without, "passes to leave out, to see what they are worth")
      ->check(CLI::IsMember({"fold", "share", "move_parameters", "refer", "pack", "write_limbs", "join", "weigh"}))
      ->delimiter(',')
      ->type_name("PASS,...");
  command.add_flag(
      "--calibrated", calibrated_,
      "choose, and expect, by what 'dalembert calibrate' has measured on this machine; else by committed constants");
  command.add_flag("--verbose", verbose_, "every warning, not only the first of each kind");
  for (const Help& help : scene_help)
    options_[help.key] =
        command.add_option(std::string("--") + help.key, texts_[help.key], help.text ? help.text : outputs_help())
            ->type_name(help.value);
}

Request SharedOptions::request() const {
  Request request = request_;
  if (calibrated_) request.costs = calibrated_costs();
  for (const std::string& key : frontend::scene_keys())
    if (options_.at(key)->count() > 0) request.settings.push_back({key, texts_.at(key)});
  return request;
}

}  // namespace dalembert
