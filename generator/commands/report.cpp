#include "commands/report.hpp"

#include <fmt/format.h>

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "backend/output_files.hpp"
#include "commands/parallel.hpp"
#include "commands/precompiled_eigen.hpp"
#include "commands/report/forms.hpp"
#include "commands/report/heading.hpp"
#include "commands/report/integration.hpp"
#include "commands/report/mujoco.hpp"
#include "commands/report/page.hpp"
#include "commands/report/rounding.hpp"
#include "commands/report/stability.hpp"
#include "commands/report/task_graph.hpp"
#include "commands/report/verdict.hpp"

namespace dalembert {

ReportSummary write_report(const Model& model, const CompilerOptions& compiler, const ReportOptions& options) {
  using namespace reporting;
  if (!model.tree.linkages.empty())
    throw InputError({Severity::error, "", fmt::format("loop '{}'", model.tree.linkages.front().loops.front().name),
                      "it is embedded, and a report's oracles and integrators know no such loop",
                      "leave 'independent' out of all loops, or ask for dalembert check"});
  // Its extreme cases are other robots, in which a part's joints stand elsewhere.
  for (const Output& output : outputs_of(model))
    if (output.part)
      throw InputError({Severity::error, "", "part of " + output.name, "a report is of whole results",
                        "ask for the whole here; 'dalembert check' compares parts"});
  backend::add_files(options.folder, {});  // where it cannot be made, says so now and not in minutes
  const Pinocchio pinocchio(model);
  std::unique_ptr<const Mujoco> mujoco;
  std::unique_ptr<const PrecompiledEigen> eigen;
  each_in_parallel(2, [&](size_t i) {
    if (i == 0) eigen = std::make_unique<PrecompiledEigen>(compiler);
    else mujoco = std::make_unique<Mujoco>(model, compiler);
  });
  const Subject subject{model, outputs_of(model), eigen->options(), options.quick, *mujoco, pinocchio};
  Rows rows;
  add_heading(subject, rows);
  add_forms(subject, rows);
  const Rounding rounding(subject);
  TaskGraph task_graph(subject);
  Integration integration(subject);
  // All that is compiled at once, the longest first: nothing is timed meanwhile.
  std::vector<Order> orders = stability_orders(subject);
  const size_t of_stability = orders.size();
  for (Order& order : rounding.orders()) orders.push_back(std::move(order));
  const Engines engines = make_engines(orders, {[&] { task_graph.compile(); }, [&] { integration.compile(); }});
  rounding.add(std::span(engines).subspan(of_stability), rows);
  add_stability(subject, std::span(engines).first(of_stability), rows);
  task_graph.add(rows);
  integration.add(rows);
  ReportSummary summary;
  summary.passed = add_verdict(rows);
  const std::string csv = rows.csv();
  backend::add_files(options.folder, {{"report.csv", csv}, {"index.html", page(model.tree.robot, csv)}});
  for (const Row& row : rows.all())
    if (row.section == "verdict") summary.text += row.value + "\n";
  summary.text += fmt::format("{0}/index.html shows it, {0}/report.csv holds it\n", options.folder);
  return summary;
}

}  // namespace dalembert
