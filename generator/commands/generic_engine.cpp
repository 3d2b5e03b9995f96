#include "commands/generic_engine.hpp"

namespace dalembert {

namespace {

Eigen::MatrixXd evaluate(const Model& model, const Output& output, const State& state, reference::Precision precision) {
  return reference::evaluate(model.tree, model.scene, {{output.quantity, output.link, output.of_link, output.selection()}},
                             inputs(state), precision)
      .front();
}

}  // namespace

reference::Inputs inputs(const State& state) {
  return {state.q, state.v, state.more, state.wrenches, state.acting, state.loading};
}

Eigen::MatrixXd evaluate_generic(const Model& model, const Output& output, const State& state) {
  return evaluate(model, output, state, reference::Precision::float64);
}

Eigen::MatrixXd evaluate_single_precision(const Model& model, const Output& output, const State& state) {
  return evaluate(model, output, state, reference::Precision::float32);
}

Eigen::MatrixXd evaluate_multiprecision(const Model& model, const Output& output, const State& state) {
  return evaluate(model, output, state, reference::Precision::digits_50);
}

}  // namespace dalembert
