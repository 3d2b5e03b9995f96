#include "idle_keys.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "ir/implicit_joints.hpp"
#include "passes/parameters.hpp"
#include "passes/reads.hpp"

namespace dalembert {
namespace {

using ir::Quantity;

class IdleKeys {
 public:
  IdleKeys(const ir::Scene& scene, const ir::KinematicTree& tree, Diagnostics& warnings)
      : scene_(scene), tree_(tree), outputs_(scene.quantities()), warnings_(warnings) {}

  bool asked(Quantity quantity) const { return std::find(outputs_.begin(), outputs_.end(), quantity) != outputs_.end(); }
  // Whether an output is asked for of which `heeds` says so.
  template <class Heeds>
  bool any(const Heeds& heeds) const {
    return std::any_of(outputs_.begin(), outputs_.end(), heeds);
  }
  // What the equations of the outputs read, found when it is first asked for.
  const passes::Reads& reads() {
    if (!reads_) reads_.emplace(tree_, scene_);
    return *reads_;
  }

  void warn(const std::string& key, const std::string& fault, const std::string& remedy) {
    warnings_.push_back({Severity::warning, "", "scene key '" + key + "'", fault, remedy});
  }

 private:
  const ir::Scene& scene_;
  const ir::KinematicTree& tree_;
  std::vector<Quantity> outputs_;
  Diagnostics& warnings_;
  std::optional<passes::Reads> reads_;
};

// Those that are not derivatives of others.
std::string quantities_of_constraints() {
  std::vector<std::string_view> names;
  for (const ir::QuantityRow& row : ir::quantities()) {
    const std::string_view name = row.name;
    const bool derivative = std::any_of(names.begin(), names.end(), [&](std::string_view of) {
      return name.size() > of.size() + 2 && name.starts_with(of) && name.substr(of.size(), 2) == "_d";
    });
    if (ir::is_of_constraints(row.quantity) && !derivative) names.push_back(name);
  }
  const std::string_view last = names.back();
  names.pop_back();
  return fmt::format("{} or {}", fmt::join(names, ", "), last);
}

}  // namespace

void warn_of_idle_keys(const ir::Scene& scene, const ir::KinematicTree& tree, Diagnostics& warnings) {
  IdleKeys keys(scene, tree, warnings);
  if (!scene.wrenches.empty() && !keys.reads().input(ir::InputKind::wrench))
    keys.warn("wrenches", "no output depends on the wrenches",
              "ask for inverse_dynamics, forward_dynamics or their derivatives");

  std::vector<std::string> named = scene.payloads;
  for (const ir::LinkOutput& output : scene.link_outputs()) named.push_back(output.link);
  for (const ir::NamedFunction& function : scene.functions)
    for (const ir::LinkOutput& output : function.of_links) named.push_back(output.link);
  for (const ir::ExternalWrench& wrench : scene.wrenches) named.push_back(wrench.link);
  for (const ir::Contact& contact : scene.contacts) named.push_back(contact.link);
  for (const ir::Loop& loop : scene.loops) named.insert(named.end(), loop.links.begin(), loop.links.end());
  for (const ir::Loop& loop : scene.embedded) named.insert(named.end(), loop.links.begin(), loop.links.end());
  for (const ir::Frame& frame : scene.placed)
    if (std::find(named.begin(), named.end(), frame.name) == named.end())
      keys.warn("frames", fmt::format("nothing is asked of frame '{}'", frame.name),
                "name what it is for under its outputs, or name the frame in functions, wrenches, payloads or contacts");

  if (scene.any_constraint() && !keys.any(ir::is_of_constraints))
    keys.warn(scene.contacts.empty() ? "loops" : "contacts", "no output depends on the contacts and loops",
              "ask for " + quantities_of_constraints());
  if (!scene.passive.empty() && !keys.any([](Quantity output) { return ir::row_of(output).scale == ir::Scale::supported; }))
    keys.warn("passive", "no output depends on which joints are passive", "ask for constrained_inverse_dynamics");

  if (scene.any_constraint() && scene.base == ir::Base::fixed && scene.passive.empty() &&
      keys.any([](Quantity output) { return ir::row_of(output).scale == ir::Scale::supported; }))
    warnings.push_back(
        {Severity::notice, "", "scene key 'passive'",
         "the base is fixed and every joint has a motor: in constrained inverse dynamics contacts and loops bear "
         "nothing, and their forces are zero",
         "name the joints without a motor, or ask for inverse_dynamics, which is the same"});

  const bool solved = keys.any([](Quantity output) { return ir::is_solved(ir::row_of(output).scale); });
  if (scene.forward_dynamics && !solved)
    keys.warn("forward_dynamics", "no output is solved for with M",
              "ask for forward_dynamics, inverse_mass_matrix or mass_matrix_factor");
  else if (scene.forward_dynamics == ir::Solver::articulated_bodies && tree.independent_joints() < tree.joints())
    keys.warn("forward_dynamics", "mimic joints are solved for by factorization all the same",
              "leave the key out, or the mimic relations");

  if (scene.coriolis == ir::Coriolis::christoffel && !keys.asked(Quantity::coriolis_matrix))
    keys.warn("coriolis", "C is not asked for", "ask for coriolis_matrix; C v is the same by either C");

  const char* const remedy_of_losses =
      scene.rates_zero ? "leave it out, or rates_zero" : "ask for bias, inverse_dynamics or forward_dynamics";
  if ((scene.urdf_damping || !scene.damping.empty()) && !keys.reads().parameter(passes::damping_p))
    keys.warn("damping", "no output depends on damping", remedy_of_losses);
  if ((scene.urdf_friction || !scene.friction.empty()) && !keys.reads().parameter(passes::friction_p))
    keys.warn("friction", "no output depends on friction", remedy_of_losses);
  if (!scene.stiffness.empty() && !keys.reads().parameter(passes::stiffness_p) &&
      !keys.reads().parameter(passes::half_stiffness_p))
    keys.warn("stiffness", "no output depends on springs",
              "ask for bias, potential_energy, inverse_dynamics or forward_dynamics");

  constexpr Quantity of_velocities[] = {Quantity::kinetic_energy, Quantity::momentum_bias, Quantity::center_of_mass_bias,
                                        Quantity::constraint_bias, Quantity::impact};
  std::vector<std::string_view> zero;
  for (const Quantity quantity : of_velocities)
    if (scene.rates_zero && keys.asked(quantity)) zero.push_back(ir::name_of(quantity));
  if (!zero.empty())
    keys.warn("rates_zero", fmt::format("{} {} zero in every state", fmt::join(zero, ", "), zero.size() == 1 ? "is" : "are"),
              "do not ask for what depends on velocities alone, or leave rates_zero out");

  if (scene.linearly_implicit && ir::implicit_joints(tree).empty())
    keys.warn("rollouts", "no joint has a damper or a spring, and linearly implicit steps are those of semi-implicit Euler",
              "give joints damping, stiffness or elastic, or leave linearly_implicit out");
  if (!scene.armature.empty() && !keys.reads().parameter(passes::armature_p) &&
      !keys.reads().parameter(passes::half_armature_p))
    keys.warn("armature", "no output depends on armature",
              "ask for mass_matrix, kinetic_energy, inverse_dynamics or forward_dynamics");
  if (scene.gravity_kind == ir::GravityKind::run_time && !keys.reads().input(ir::InputKind::gravity))
    keys.warn("gravity", "no output depends on gravity", "leave run_time out");
  if (!scene.payloads.empty() && !keys.reads().mass())
    keys.warn("payloads", "no output depends on masses",
              "leave the payloads out; the regressor's columns are the same with them");
}

}  // namespace dalembert
