#include "commands/report/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "commands/report/rounding.hpp"
#include "commands/report/stability.hpp"
#include "commands/report/task_graph.hpp"
#include "ir/quantity.hpp"

namespace dalembert::reporting {
namespace {

double number(const Row& row) { return std::strtod(row.value.c_str(), nullptr); }

class Verdict {
 public:
  explicit Verdict(const Rows& rows) : rows_(rows.all()) {}

  // M: 1.5 ulp at worst, 179 ns, 63 times faster than the generic engine and 4 times faster than MuJoCo.
  std::vector<std::string> quantities() const {
    std::vector<std::string> sentences;
    for (const Row& chosen : rows_) {
      if (chosen.metric != "chosen") continue;
      const std::string& q = chosen.quantity;
      const double time = of(q, chosen.variant, "time_median");
      if (q == "all") {
        sentences.push_back(fmt::format("All together: {}.", nanoseconds(time)));
        continue;
      }
      const auto known = ir::quantity_named(q);
      sentences.push_back(fmt::format(
          "{}: at worst {:.2g} ulp off in {:g} random states, {} a call, {:.3g} times faster than the generic engine{}.",
          known ? ir::row_of(*known).symbol : q, of(q, chosen.variant, "ulp_worst"), of(q, chosen.variant, "states"),
          nanoseconds(time), of(q, chosen.variant, "times_faster"), beside_mujoco(q, chosen.variant)));
    }
    return sentences;
  }

  std::string weakest() const {
    const Row* worst = nullptr;
    for (const Row& row : rows_)
      if (row.section == "stability" && row.metric == "ulp_worst" && row.variant == "generated double" &&
          (!worst || number(row) > number(*worst)))
        worst = &row;
    if (!worst) return "";
    return fmt::format("Weakest extreme case in double: {}, {}, {:.2g} ulp.", worst->subject, worst->quantity, number(*worst));
  }

  std::vector<std::string> failures(const std::string& variant) const {
    std::vector<std::string> list;
    for (const Row& row : rows_)
      if (row.section == "stability" && row.metric == "violated" && row.variant == variant)
        list.push_back(fmt::format("{} ({}: {})", row.subject, row.quantity, row.value));
    return list;
  }

  // What the task graph computes otherwise than the functions it calls; empty: nothing.
  std::string changed_by_tasks() const {
    const double changed = of("all", task_graph_variant, "elements_changed");
    return changed == 0 ? "" : fmt::format("The task graph changes {:g} elements: something is wrong.", changed);
  }

 private:
  std::string beside_mujoco(const std::string& quantity, const std::string& variant) const {
    const double times = of(quantity, variant, "times_faster_than_mujoco");
    if (times == 0) return "";
    return times < 1 ? fmt::format("; MuJoCo takes {:.3g} times as long", times)
                     : fmt::format(" and {:.3g} times faster than MuJoCo", times);
  }
  double of(const std::string& quantity, const std::string& variant, const char* metric) const {
    for (const Row& row : rows_)
      if (row.section == "rounding" && row.quantity == quantity && row.variant == variant && row.metric == metric)
        return number(row);
    return 0;  // no such row
  }
  static std::string nanoseconds(double time) { return fmt::format("{:.3g} ns", time); }

  const std::vector<Row>& rows_;
};

}  // namespace

bool add_verdict(Rows& rows) {
  const Verdict verdict(rows);
  std::vector<std::string> sentences = verdict.quantities();
  sentences.push_back(verdict.weakest());
  const std::vector<std::string> in_double = verdict.failures("generated double"),
                                 in_float = verdict.failures("generated float");
  const auto tell = [](const char* scalar, const std::vector<std::string>& list) {
    if (list.empty()) return fmt::format("No case goes badly in {}.", scalar);
    return fmt::format("Goes badly in {}: {}.", scalar, fmt::join(list, "; "));
  };
  sentences.push_back(tell("double", in_double));
  sentences.push_back(tell("float", in_float));
  const std::string changed = verdict.changed_by_tasks();
  sentences.push_back(changed);
  for (const std::string& sentence : sentences)
    if (!sentence.empty()) rows.text("verdict", "", "", "", "sentence", sentence);
  return in_double.empty() && changed.empty();
}

}  // namespace dalembert::reporting
