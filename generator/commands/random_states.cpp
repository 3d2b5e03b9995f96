#include "commands/random_states.hpp"

#include <fmt/format.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>

#include "reference/loading.hpp"

namespace dalembert {

namespace {

// Uniform numbers, the same on every system (the distributions of <random> are not).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed = 2016) : engine_(seed) {}
  double operator()(double low, double high) { return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53; }

 private:
  std::mt19937_64 engine_;
};

}  // namespace

std::vector<State> random_states(const ir::KinematicTree& tree, int count) {
  Uniform uniform;
  const int base = tree.base_positions();
  std::vector<State> states;
  for (int s = 0; s < count; ++s) {
    State state{fmt::format("random state {}", s), Eigen::VectorXd(tree.nq()), Eigen::VectorXd(tree.nv()),
                Eigen::VectorXd(tree.nv()), Eigen::VectorXd(6 * static_cast<Eigen::Index>(tree.pushed.size()))};
    for (int i = 0; i < base; ++i) state.q[i] = uniform(-1, 1);
    int coordinate = base;
    for (const ir::Body& body : tree.bodies)
      for (int i = 0; i < body.positions(); ++i)
        state.q[coordinate++] = body.has_quaternion() ? uniform(-1, 1)
                                : body.turns()        ? uniform(-std::numbers::pi, std::numbers::pi)
                                                      : uniform(-0.5, 0.5);
    for (const int first : tree.quaternions()) state.q.segment<4>(first).normalize();
    if (!tree.linkages.empty()) ir::draw_closed(tree, state.q, 400, ir::well_off_toggle_points, true);
    for (int i = 0; i < tree.nv(); ++i) state.v[i] = uniform(-2, 2);
    for (int i = 0; i < tree.nv(); ++i) state.more[i] = uniform(-2, 2);
    for (double& x : state.wrenches) x = uniform(-20, 20);
    states.push_back(std::move(state));
  }
  return states;
}

ir::Acting random_acting(const ir::Scene& scene, unsigned number) {
  Uniform uniform(number);
  ir::Acting acting;
  const std::vector<ir::Constraint> constraints = scene.constraints();
  for (std::size_t c = 0; c < constraints.size(); ++c) {
    acting.active.push_back(uniform(0, 1) < 0.5);
    acting.restitution.push_back(uniform(0, 1));
  }
  acting.weights.resize(scene.constraint_rows());
  for (double& weight : acting.weights) weight = uniform(0.1, 1);
  if (uniform(0, 1) < 0.5) return acting;
  acting.regularization.resize(scene.constraint_rows());
  for (double& more : acting.regularization) more = uniform(0.1, 1);
  return acting;
}

ir::Loading random_loading(const ir::KinematicTree& tree, const ir::Scene& scene, unsigned number) {
  Uniform uniform(number);
  ir::Loading loading;
  for (std::size_t i = 0; i < scene.payloads.size(); ++i) {
    ir::Inertia payload = reference::make_payload(tree, static_cast<int>(i));
    const double more = uniform(0.2, 2);
    payload.mass *= more;
    payload.inertia *= more;
    for (double& x : payload.com) x = uniform(-0.1, 0.1);
    loading.payloads.push_back(payload);
  }
  if (scene.gravity_kind == ir::GravityKind::run_time) {
    const double z = uniform(-1, 1), angle = uniform(-std::numbers::pi, std::numbers::pi), away = std::sqrt(1 - z * z);
    loading.gravity = uniform(5, 12) * Eigen::Vector3d(away * std::cos(angle), away * std::sin(angle), z);
  }
  return loading;
}

}  // namespace dalembert
