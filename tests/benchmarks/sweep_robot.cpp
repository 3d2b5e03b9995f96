#include "sweep_robot.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "commands/random_states.hpp"
#include "compile.hpp"
#include "frontend/urdf_reader.hpp"
#include "reference/engine.hpp"
#include "reference/generic_model.hpp"
#include "tree_text.hpp"

namespace dalembert::benchmarks {
namespace {

Model model_of(const Shape& shape, const Sizes& sizes) {
  Diagnostics warnings;
  Model model;
  model.description = shape.branches == 0
                          ? frontend::read_urdf(MAHRU, warnings)
                          : frontend::read_urdf_text(shape.name, tree_text(shape.joints, shape.branches), warnings);
  model.name = "robot";
  const char* outputs = sizes.M && sizes.C ? "mass_matrix,coriolis_matrix" : sizes.M ? "mass_matrix" : "coriolis_matrix";
  const std::vector<frontend::Setting> settings{
      {"base", shape.branches == 0 ? "floating" : "fixed"}, {"outputs", outputs}, {"parallel", "tasks"}};
  apply_scene(model, frontend::read_scene_text("", "", settings), warnings);
  return model;
}

// C functions for the task graph, as those of c_api.h for evaluate().
std::string graph_text(const Sizes& sizes) {
  std::string text =
      "#include \"tasks.hpp\"\n"
      "struct Graph { robot::Workspace workspace; robot::TaskGraph graph{workspace}; };\n"
      "extern \"C\" {\n"
      "void* graph_create() { return new Graph; }\n"
      "void graph_destroy(void* graph) { delete static_cast<Graph*>(graph); }\n"
      "void graph_evaluate(const double* q, const double* v, void* graph) { static_cast<Graph*>(graph)->graph.evaluate(q, v); "
      "}\n";
  for (const char* matrix : {"mass_matrix", "coriolis_matrix"})
    if (matrix == std::string("mass_matrix") ? sizes.M : sizes.C)
      text +=
          fmt::format("const double* graph_{0}(void* graph) {{ return static_cast<Graph*>(graph)->workspace.{0}; }}\n", matrix);
  return text + "}\n";
}

}  // namespace

SweepRobot::SweepRobot(const Shape& shape, const Sizes& sizes) : model_(model_of(shape, sizes)) {
  std::vector<backend::OutputFile> files = compile_without_self_test(model_);
  std::string whole;  // one translation unit: most of the time goes with headers
  for (backend::OutputFile& file : files)
    if (file.name.ends_with(".cpp")) {
      file.name += ".inc";
      whole += fmt::format("#include \"{}\"\n", file.name);
    }
  files.push_back({"whole.cpp", whole + graph_text(sizes)});
  code_ = std::make_unique<LoadedCode>("robot", files, CompilerOptions{});
  serial_ = side("robot_");
  tasks_ = side("graph_");
  generic_ = std::make_unique<generic::Model<double>>(to_generic<double>(model_.tree, model_.scene.gravity));
  paper_ = std::make_unique<PaperParallel>(*generic_, sizes.M, sizes.C);
  states_ = random_states(model_.tree, state_count);
  std::vector<reference::Wanted> wanted;
  if (sizes.M) wanted.push_back({ir::Quantity::mass_matrix, ""});
  if (sizes.C) wanted.push_back({ir::Quantity::coriolis_matrix, ""});
  const auto precision = model_.tree.joints() <= 50 ? reference::Precision::digits_50 : reference::Precision::extended;
  std::vector<Eigen::MatrixXd> exact =
      reference::evaluate(model_.tree, model_.scene, wanted, {states_[0].q, states_[0].v}, precision);
  if (sizes.M) exact_.M = std::move(exact.front());
  if (sizes.C) exact_.C = std::move(exact.back());
}

SweepRobot::Side SweepRobot::side(const std::string& prefix) const {
  Side side;
  side.workspace = {code_->function<void*()>(prefix + "create")(), code_->function<void(void*)>(prefix + "destroy")};
  side.evaluate = code_->function<Evaluate>(prefix + "evaluate");
  if (code_->has(prefix + "mass_matrix")) side.M = code_->function<Result>(prefix + "mass_matrix");
  if (code_->has(prefix + "coriolis_matrix")) side.C = code_->function<Result>(prefix + "coriolis_matrix");
  return side;
}

void SweepRobot::evaluate(const State& state) { serial_.evaluate(state.q.data(), state.v.data(), serial_.workspace.get()); }
void SweepRobot::evaluate_in_tasks(const State& state) {
  tasks_.evaluate(state.q.data(), state.v.data(), tasks_.workspace.get());
}

Matrices SweepRobot::matrices(const double* M, const double* C) const {
  const int nv = model_.tree.nv();
  Matrices result;
  if (M) result.M = Eigen::Map<const Eigen::MatrixXd>(M, nv, nv);
  if (C) result.C = Eigen::Map<const Eigen::MatrixXd>(C, nv, nv);
  return result;
}

Matrices SweepRobot::generated() const {
  void* from = serial_.workspace.get();
  return matrices(serial_.M ? serial_.M(from) : nullptr, serial_.C ? serial_.C(from) : nullptr);
}

Matrices SweepRobot::generated_in_tasks() const {
  void* from = tasks_.workspace.get();
  return matrices(tasks_.M ? tasks_.M(from) : nullptr, tasks_.C ? tasks_.C(from) : nullptr);
}

double SweepRobot::error_of(const Matrices& at_state_0) const {
  const auto error = [](const Eigen::MatrixXd& ours, const Eigen::MatrixXd& exact) {
    return exact.size() == 0 ? 0 : (ours - exact).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() / exact.cwiseAbs().maxCoeff();
  };
  return std::max(error(at_state_0.M, exact_.M), error(at_state_0.C, exact_.C));
}

}  // namespace dalembert::benchmarks
