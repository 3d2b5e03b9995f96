#include "commands/report/subject.hpp"

#include "commands/generic_engine.hpp"

namespace dalembert::reporting {
namespace {

std::vector<reference::Wanted> wanted(const std::vector<Output>& outputs) {
  std::vector<reference::Wanted> list;
  for (const Output& output : outputs) list.push_back({output.quantity, output.link, output.of_link, output.selection()});
  return list;
}

}  // namespace

Exact exact_at(const Model& model, const std::vector<Output>& outputs, const State& state) {
  const std::vector<reference::Wanted> list = wanted(outputs);
  const reference::Inputs inputs = dalembert::inputs(state);
  Exact exact{reference::evaluate(model.tree, model.scene, list, inputs, reference::Precision::digits_50), {}};
  reference::LeastScale scale(model.tree, model.scene, inputs);
  for (const reference::Wanted& w : list) exact.least_scales.push_back(scale.of(w));
  return exact;
}

std::vector<Eigen::MatrixXd> generic_at(const Model& model, const std::vector<Output>& outputs, const State& state) {
  return reference::evaluate(model.tree, model.scene, wanted(outputs), inputs(state), reference::Precision::float64);
}

State rounded_to_float(State state) {
  state.q = state.q.cast<float>().cast<double>();
  state.v = state.v.cast<float>().cast<double>();
  state.more = state.more.cast<float>().cast<double>();
  return state;
}

}  // namespace dalembert::reporting
