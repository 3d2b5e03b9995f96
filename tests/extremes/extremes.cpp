#include "extremes.hpp"

#include <stdlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <vector>

#include "commands/generated_engine.hpp"
#include "commands/random_states.hpp"
#include "commands/report/errors.hpp"
#include "commands/report/subject.hpp"
#include "reference/eigenvalues.hpp"

namespace dalembert::extremes {

Model model_of(const Robot& robot) {
  std::string folder = (std::filesystem::temp_directory_path() / "dalembert_extreme.XXXXXX").string();
  if (!mkdtemp(folder.data())) throw std::runtime_error("no temporary folder");
  Request request;
  request.robot = folder + "/" + robot.name + ".urdf";
  std::ofstream(request.robot) << robot.urdf;
  request.settings = {{"base", robot.floating ? "floating" : "fixed"},
                      {"outputs", "mass_matrix,coriolis_matrix,gravity,bias,forward_dynamics"}};
  Diagnostics warnings;
  Model model = read_model(request, warnings);
  std::filesystem::remove_all(folder);
  return model;
}

namespace {

// As far as double tells the smallest eigenvalue from zero.
double condition(const Eigen::MatrixXd& M) {
  const Eigen::VectorXd values = reference::eigenvalues(M);
  const double largest = values.tail<1>()[0];
  return largest / std::max(values[0], 0x1p-52 * largest);
}

}  // namespace

Figures measure(const Robot& robot, int states, const std::string& flags) {
  const Model model = model_of(robot);
  const std::vector<Output> outputs = outputs_of(model);
  GeneratedEngine engine(model, outputs, {"", flags, 0});
  Figures figures;
  for (const State& state : random_states(model.tree, states)) {
    const reporting::Exact exact = reporting::exact_at(model, outputs, state);
    const Eigen::VectorXd d = exact.results[0].diagonal().cwiseSqrt().cwiseInverse();
    const auto divided = [&](const Eigen::MatrixXd& x) -> Eigen::MatrixXd {
      return x.cols() == 1 ? Eigen::MatrixXd(d.asDiagonal() * x) : Eigen::MatrixXd(d.asDiagonal() * x * d.asDiagonal());
    };
    engine.evaluate(state);
    for (size_t o = 0; o < figures.ulp.size(); ++o) {
      const Eigen::MatrixXd result = engine.result(outputs[o]);
      figures.finite = figures.finite && result.allFinite();
      const auto ulp = [&](const Eigen::MatrixXd& ours, const Eigen::MatrixXd& right, double scale) {
        return reporting::error_of(ours, right, scale, ir::ScalarType::float64).ulp;
      };
      figures.ulp[o] = std::max(figures.ulp[o], ulp(result, exact.results[o], exact.least_scales[o]));
      figures.normalised[o] = std::max(figures.normalised[o], ulp(divided(result), divided(exact.results[o]), 0));
    }
    const double own = condition(exact.results[0]), scaled = condition(divided(exact.results[0]));
    figures.condition = std::max(figures.condition, scaled);
    const Eigen::VectorXd solved = engine.result(outputs.back()), right = exact.results.back();
    figures.finite = figures.finite && solved.allFinite();
    if (engine.status(outputs.back()) >= 0) {
      figures.reported = true;
    } else {
      const auto error = [&](const Eigen::VectorXd& ours, const Eigen::VectorXd& exactly, double limit) {
        return (ours - exactly).norm() / exactly.norm() / (10 * limit * 0x1p-53);
      };
      figures.forward = std::max(figures.forward, error(solved, right, own));
      figures.forward_normalised =
          std::max(figures.forward_normalised, error(solved.cwiseQuotient(d), right.cwiseQuotient(d), scaled));
    }
  }
  return figures;
}

}  // namespace dalembert::extremes
