#include "commands/eval.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>

#include "commands/batch_engine.hpp"
#include "commands/finite_inputs.hpp"
#include "commands/generated_engine.hpp"
#include "commands/generic_engine.hpp"
#include "commands/json.hpp"
#include "commands/labels.hpp"
#include "passes/joints_without_mass.hpp"
#include "reference/solvable.hpp"

namespace dalembert {

namespace {

void append_rows(std::string& text, const Eigen::MatrixXd& matrix) {
  for (Eigen::Index i = 0; i < matrix.rows(); ++i)
    for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
      const double x = matrix(i, k);
      text += std::isnan(x) ? "nan" : fmt::format("{:.17g}", x);
      text += k + 1 < matrix.cols() ? ' ' : '\n';
    }
}

// What stands between blanks has none.
std::string in_one_word(std::string name) {
  for (char& c : name)
    if (c == ' ' || c == '\t') c = '_';
  return name;
}

// In columns as wide as their widest word.
std::string labelled(const Labels& labels, const Eigen::MatrixXd& matrix) {
  std::vector<std::vector<std::string>> lines;
  if (!labels.columns.empty()) {
    lines.push_back({""});
    for (const std::string& column : labels.columns) lines.back().push_back(in_one_word(column));
  }
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    lines.push_back({labels.rows.empty() ? "" : in_one_word(labels.rows[static_cast<size_t>(i)])});
    for (Eigen::Index k = 0; k < matrix.cols(); ++k)
      lines.back().push_back(std::isnan(matrix(i, k)) ? "nan" : fmt::format("{:.6g}", matrix(i, k)));
  }
  std::vector<size_t> widths(lines.front().size(), 0);
  for (const std::vector<std::string>& line : lines)
    for (size_t k = 0; k < line.size(); ++k) widths[k] = std::max(widths[k], line[k].size());
  std::string text;
  for (const std::vector<std::string>& line : lines) {
    if (widths[0] > 0) text += fmt::format("{:<{}}", line[0], widths[0]);
    for (size_t k = 1; k < line.size(); ++k) text += fmt::format("{}{:>{}}", text.empty() ? "" : "  ", line[k], widths[k]);
    text += '\n';
  }
  return text;
}

// A list of rows, each a list.
std::string json_rows(const Eigen::MatrixXd& matrix) {
  std::string text;
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    text += i == 0 ? "[" : ", [";
    for (Eigen::Index k = 0; k < matrix.cols(); ++k)
      text += (k == 0 ? "" : ", ") + (std::isfinite(matrix(i, k)) ? fmt::format("{:.17g}", matrix(i, k)) : "null");
    text += "]";
  }
  return "[" + text + "]";
}

// Dynamics with embedded loops mean something where these are closed.
void warn_of_open_loops(const ir::KinematicTree& tree, const std::string& place, const State& state, Diagnostics& warnings) {
  constexpr double noticeable = 1e-6;  // m, rad
  Eigen::VectorXd q = state.q;
  if (const double open = ir::close_loops(tree, 0, q).error; open > noticeable)
    warnings.push_back(
        {Severity::warning, place, state.place, fmt::format("embedded loops are open by {:.3g}", open),
         "give positions of dependent joints at which they are closed: generated code's close_loops() finds them"});
}

}  // namespace

std::string evaluate(const Model& model, const std::string& state_file, const std::string& output, Engine engine, Style style,
                     const CompilerOptions& options, Diagnostics& warnings) {
  const Output wanted = output_named(model, output);
  const ir::Scene scene = with_outputs(model, {wanted}).scene;
  passes::check_mass(model.description, model.tree, scene);
  reference::check_solvable(model.description, model.tree, scene, warnings);
  const std::vector<State> states = read_states(state_file, model.tree, wanted.function.inputs, warnings);
  std::unique_ptr<GeneratedEngine> generated;
  if (engine == Engine::generated) generated = std::make_unique<GeneratedEngine>(model, std::vector{wanted}, options);

  std::unique_ptr<BatchEngine> batch;
  if (engine == Engine::batch) {
    batch = std::make_unique<BatchEngine>(model, std::vector{wanted}, options);
    batch->evaluate(states);
  }

  const Labels labels = labels_of(model, wanted);
  std::string text;
  const std::string place = state_file == "-" ? "standard input" : state_file;
  for (size_t s = 0; s < states.size(); ++s) {
    const State& state = states[s];
    Eigen::MatrixXd result;
    if (batch) {
      result = batch->result(wanted, s);
    } else if (generated) {
      generated->evaluate(state);
      result = generated->result(wanted);
    } else {
      result = evaluate_generic(model, wanted, state);
    }
    warn_of_open_loops(model.tree, place, state, warnings);
    check_finite_inputs(model, wanted, place, state, result.allFinite());
    if (!result.allFinite())
      warnings.push_back({Severity::warning, place, state.place, fmt::format("{} is not finite at this state", output),
                          "look for huge numbers on that line"});
    if (style == Style::json) {
      text += (text.empty() ? "\n    " : ",\n    ") + json_rows(result);
      continue;
    }
    if (!text.empty()) text += '\n';
    if (style == Style::labels) text += labelled(labels, result);
    else append_rows(text, result);
  }
  if (style != Style::json) return text;
  const Words words = words_of(wanted);
  return fmt::format(
      "{{\n  \"output\": {},\n  \"symbol\": {},\n  \"unit\": {},\n  \"help\": {},\n  \"rows\": {},\n  \"columns\": {},\n"
      "  \"states\": [{}\n  ]\n}}\n",
      json_string(wanted.name), json_string(words.symbol), json_string(words.unit), json_string(words.help),
      json_array(labels.rows), json_array(labels.columns), text);
}

}  // namespace dalembert
