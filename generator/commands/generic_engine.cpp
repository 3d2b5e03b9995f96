#include "commands/generic_engine.hpp"

#include <algorithm>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <dalembert/generic/dynamics.hpp>

#include "commands/generic_model.hpp"

namespace dalembert {

namespace {

template <class S>
MatrixX<S> jacobian(const Model& model, const generic::Model<S>& robot, const std::string& link, const VectorX<S>& q) {
  const auto placed = std::find_if(model.tree.links.begin(), model.tree.links.end(),
                                   [&](const ir::LinkPlacement& p) { return p.link == link; });
  return generic::link_jacobian<S>(
      robot, q, placed->body,
      {placed->placement.linear().template cast<S>(), placed->placement.translation().template cast<S>()});
}

template <class S>
MatrixX<S> evaluate(const Model& model, const Output& output, const State& state) {
  const generic::Model<S> robot = to_generic<S>(model.tree, model.scene.gravity);
  const VectorX<S> q = state.q.cast<S>();
  VectorX<S> v = state.v.cast<S>();
  if (model.scene.rates_zero) v.setZero();
  if (!output.quantity) return jacobian<S>(model, robot, output.link, q);
  switch (*output.quantity) {
    case ir::Quantity::mass_matrix: return generic::mass_matrix<S>(robot, q);
    case ir::Quantity::coriolis_matrix: return generic::coriolis_matrix<S>(robot, q, v);
    case ir::Quantity::gravity: return generic::gravity<S>(robot, q);
    case ir::Quantity::bias: return generic::bias<S>(robot, q, v);
    case ir::Quantity::wrench_influence: return generic::wrench_influence<S>(robot, q);
  }
  return {};
}

}  // namespace

Eigen::MatrixXd evaluate_generic(const Model& model, const Output& output, const State& state) {
  return evaluate<double>(model, output, state);
}

Eigen::MatrixXd evaluate_multiprecision(const Model& model, const Output& output, const State& state) {
  using Digits50 = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<50>, boost::multiprecision::et_off>;
  return evaluate<Digits50>(model, output, state).template cast<double>();
}

}  // namespace dalembert
