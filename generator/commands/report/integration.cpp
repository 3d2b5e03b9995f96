#include "commands/report/integration.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <dalembert/integrators/implicit_midpoint.hpp>
#include <dalembert/integrators/linearly_implicit.hpp>
#include <dalembert/integrators/rk4.hpp>
#include <dalembert/integrators/semi_implicit_euler.hpp>
#include <iterator>
#include <limits>

#include "commands/generated_engine.hpp"
#include "commands/random_states.hpp"
#include "commands/report/progress.hpp"
#include "reference/trajectory.hpp"

namespace dalembert::reporting {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using reference::Motion;

namespace {

constexpr double seconds = 0.2, stiff_seconds = 1, stiff_step = 1e-3;
constexpr double spring_stiffnesses[] = {1e3, 1e6, 1e9};  // N m/rad or N/m
constexpr long stability_steps = 200;
constexpr int largest_robot = 100;  // coordinates; beyond, the reference takes longer than all the rest

}  // namespace

// The robot's dynamics as the integrators want them, with springs towards a position in every joint beside the scene's.
class Simulated {
 public:
  Simulated(const Model& model, const CompilerOptions& compiler)
      : tree_(model.tree),
        outputs_(outputs_of(with_quantities(model))),
        engine_(with_quantities(model), outputs_, compiler),
        damping_(VectorXd::Zero(tree_.nv())),
        own_stiffness_(VectorXd::Zero(tree_.nv())),
        rest_(VectorXd::Zero(tree_.nq())) {
    const std::vector<int> coordinates = tree_.positions();
    for (size_t k = 0; k < tree_.bodies.size(); ++k)
      if (!tree_.bodies[k].driven()) {
        damping_[base() + coordinates[k]] = tree_.bodies[k].damping;
        own_stiffness_[base() + coordinates[k]] = tree_.bodies[k].spring.k;
      }
  }

  void set_springs(double stiffness, const VectorXd& rest) {
    stiffness_ = stiffness;
    rest_ = rest;
  }

  VectorXd acceleration(const VectorXd& q, const VectorXd& v) {
    engine_.evaluate({"", q, v});
    return engine_.result(outputs_[0]).ldlt().solve(force(q));
  }

  integrators::Linearised<double, Eigen::Dynamic> linearised(const VectorXd& q, const VectorXd& v) {
    engine_.evaluate({"", q, v});
    MatrixXd damping = engine_.result(outputs_[1]), springs = MatrixXd::Zero(v.size(), v.size());
    damping.diagonal() += damping_;
    springs.diagonal().tail(v.size() - base()).setConstant(stiffness_);
    springs.diagonal() += own_stiffness_;
    return {engine_.result(outputs_[0]), damping, springs, force(q)};
  }

 private:
  static Model with_quantities(Model model) {
    model.scene.outputs = {ir::Quantity::mass_matrix, ir::Quantity::coriolis_matrix, ir::Quantity::bias};
    model.scene.jacobians.clear();
    model.scene.scalar = ir::ScalarType::float64;
    return model;
  }
  Eigen::Index base() const { return tree_.base_coordinates(); }
  VectorXd force(const VectorXd& q) const {
    VectorXd f = -engine_.result(outputs_[2]);
    const Eigen::Index joints = f.size() - base();
    f.tail(joints) -= stiffness_ * (q - rest_).tail(joints);
    return f;
  }

  const ir::KinematicTree& tree_;
  std::vector<Output> outputs_;
  GeneratedEngine engine_;
  VectorXd damping_, own_stiffness_, rest_;  // the scene's, and where springs added to them are at rest; of v's and q's layout
  double stiffness_ = 0;                     // of those
};

namespace {

struct Integrator {
  const char* name;
  bool (*step)(Simulated&, double h, VectorXd& q, VectorXd& v);  // false: it gives up
};

constexpr Integrator all_integrators[] = {
    {"semi-implicit Euler",
     [](Simulated& s, double h, VectorXd& q, VectorXd& v) { return integrators::semi_implicit_euler(s, h, q, v), true; }},
    {"RK4", [](Simulated& s, double h, VectorXd& q, VectorXd& v) { return integrators::rk4(s, h, q, v), true; }},
    {"implicit midpoint",
     [](Simulated& s, double h, VectorXd& q, VectorXd& v) { return integrators::implicit_midpoint(s, h, q, v); }},
    {"linearly implicit",
     [](Simulated& s, double h, VectorXd& q, VectorXd& v) { return integrators::linearly_implicit(s, h, q, v), true; }},
};

double difference(const Motion& a, const Motion& b) {
  const double largest =
      std::max((a.q - b.q).cwiseAbs().maxCoeff<Eigen::PropagateNaN>(), (a.v - b.v).cwiseAbs().maxCoeff<Eigen::PropagateNaN>());
  return std::isnan(largest) ? std::numeric_limits<double>::infinity() : largest;
}

void add_free_motion(const Subject& subject, Simulated& simulated, const Motion& start, Progress& progress, Rows& rows) {
  const Model& model = subject.model;
  const Motion exact = reference::trajectory(model.tree, model.scene, start, seconds);
  const auto energy = [&](const Motion& at) {
    return reference::kinetic_energy(model.tree, model.scene, at) + reference::potential_energy(model.tree, model.scene, at);
  };
  // Dampers and friction take energy in the right motion, too.
  const double right = energy(exact), moving = reference::kinetic_energy(model.tree, model.scene, start);
  std::vector<double> steps = {8e-3, 4e-3, 2e-3, 1e-3};
  if (!subject.quick) steps.insert(steps.end(), {5e-4, 2.5e-4, 1.25e-4});
  for (const Integrator& integrator : all_integrators) {
    double order = std::numeric_limits<double>::quiet_NaN(), error_before = 0;
    for (double h : steps) {
      Motion at;
      bool good = true;
      std::array<double, 3> times;
      for (double& time : times) {
        at = start;
        const auto begin = std::chrono::steady_clock::now();
        for (int i = 0, count = static_cast<int>(std::lround(seconds / h)); good && i < count; ++i)
          good = integrator.step(simulated, h, at.q, at.v);
        time = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
      }
      std::sort(times.begin(), times.end());
      const double error = good ? difference(at, exact) : std::numeric_limits<double>::infinity();
      const auto add = [&](const char* metric, double value, const char* unit) {
        rows.number("integration", fmt::format("free motion, step {} ms", h * 1e3), "state", integrator.name, metric, value,
                    unit);
      };
      add("error", error, "m, rad, m/s, rad/s");
      add("time", times[1] / seconds, "s per s");
      if (std::isfinite(error)) add("energy_drift", (energy(at) - right) / moving, "of kinetic energy");
      // Errors between chaos and rounding tell the order.
      if (error_before < 0.1 && error > 1e-10) order = std::log2(error_before / error);
      error_before = error;
    }
    if (std::isfinite(order)) rows.number("integration", "free motion", "state", integrator.name, "order", order, "1");
    progress.step();
  }
}

// The largest speed within a number of steps; infinite where the integrator gives up or diverges.
double largest_speed(Simulated& simulated, const Integrator& integrator, Motion at, double h, long steps) {
  double largest = 0;
  for (long i = 0; i < steps; ++i) {
    if (!integrator.step(simulated, h, at.q, at.v)) return std::numeric_limits<double>::infinity();
    const double speed = at.v.cwiseAbs().maxCoeff<Eigen::PropagateNaN>();
    if (!(speed < 1e6)) return std::numeric_limits<double>::infinity();
    largest = std::max(largest, speed);
  }
  return largest;
}

// Of 8 ms, 4 ms, 2 ms and so on, the first of which many steps stay bounded, s; 0: none down to a nanosecond.
double largest_stable_step(Simulated& simulated, const Integrator& integrator, const Motion& start) {
  for (double h = 8e-3; h > 1e-9; h /= 2)
    if (std::isfinite(largest_speed(simulated, integrator, start, h, stability_steps))) return h;
  return 0;
}

void add_springs(Simulated& simulated, Motion start, Progress& progress, Rows& rows) {
  start.v *= 0.1;
  for (double stiffness : spring_stiffnesses) {
    const std::string name = fmt::format("springs of {:.0e}", stiffness);
    simulated.set_springs(stiffness, start.q);
    for (const Integrator& integrator : all_integrators) {
      const double speed = largest_speed(simulated, integrator, start, stiff_step, std::lround(stiff_seconds / stiff_step));
      rows.number("integration", name, "state", integrator.name, "largest_speed", speed, "m/s, rad/s");
      rows.text("integration", name, "state", integrator.name, "verdict", std::isfinite(speed) ? "good" : "bad");
      rows.number("integration", name, "state", integrator.name, "largest_stable_step",
                  largest_stable_step(simulated, integrator, start), "s");
      progress.step();
    }
  }
}

// A random state with the scene's springs at rest: pulled at random, a stiff one would hold more energy than all the rest.
State start_state(const ir::KinematicTree& tree) {
  State state = random_states(tree, 1).front();
  const std::vector<int> coordinates = tree.positions();
  for (size_t k = 0; k < tree.bodies.size(); ++k)
    if (tree.bodies[k].spring.k != 0) state.q[tree.base_positions() + coordinates[k]] = tree.bodies[k].spring.rest;
  return state;
}

// Why there is nothing to simulate; empty when there is.
std::string obstacle(const Model& model) {
  if (model.tree.nv() == 0) return "nothing moves";
  if (model.tree.nv() > largest_robot) return fmt::format("more than {} coordinates", largest_robot);
  if (model.scene.rates_zero) return "the scene is of statics";
  for (const ir::Body& body : model.tree.bodies)
    if (body.friction != 0) return "Coulomb friction makes the motion uneven";
  return "";
}

}  // namespace

Integration::Integration(const Subject& subject) : subject_(subject), why_not_(obstacle(subject.model)) {}
Integration::~Integration() = default;

void Integration::compile() {
  if (why_not_.empty()) simulated_ = std::make_unique<Simulated>(subject_.model, subject_.compiler);
}

void Integration::add(Rows& rows) const {
  const auto not_simulated = [&](const char* what, const std::string& why) {
    rows.text("integration", what, "", "", "not_simulated", why);
  };
  if (!simulated_) return not_simulated("", why_not_);
  const Model& model = subject_.model;
  const State state = start_state(model.tree);
  if (!std::isfinite(reference::mass_condition(model.tree, model.scene, {state.q, state.v})))
    return not_simulated("", "the mass matrix is not positive definite");
  Progress progress("simulating", std::size(all_integrators) * (1 + std::size(spring_stiffnesses)));
  try {
    add_free_motion(subject_, *simulated_, {state.q, state.v}, progress, rows);
  } catch (const reference::NoTrajectory& none) {
    not_simulated("free motion", none.what());
  }
  add_springs(*simulated_, {state.q, state.v}, progress, rows);
}

}  // namespace dalembert::reporting
