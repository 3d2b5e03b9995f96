#include "commands/report/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdlib>
#include <vector>

#include "commands/report/mujoco.hpp"
#include "commands/report/pinocchio.hpp"
#include "commands/report/rounding.hpp"
#include "commands/report/stability.hpp"
#include "commands/report/task_graph.hpp"
#include "commands/timing.hpp"
#include "ir/quantity.hpp"

namespace dalembert::reporting {
namespace {

double number(const Row& row) { return std::strtod(row.value.c_str(), nullptr); }

class Verdict {
 public:
  explicit Verdict(const Rows& rows) : rows_(rows.all()) {}

  // M: 1.5 ulp at worst, 179 ns a call, 4 times as fast as MuJoCo.
  std::vector<std::string> quantities() const {
    std::vector<std::string> sentences;
    for (const Row& chosen : rows_) {
      if (chosen.metric != "chosen") continue;
      const std::string& q = chosen.quantity;
      const double time = of(q, chosen.variant, "time_median");
      if (q == "all") {
        sentences.push_back(fmt::format("All together: {}.", time_text(time)));
        continue;
      }
      std::string beside;
      for (const Peer& peer : peers)
        if (const double times = of(q, chosen.variant, peer.metric); times > 0)
          beside += fmt::format(", {:.3g} times as fast as {}", times, peer.name);
      sentences.push_back(fmt::format("{}: at worst {:.2g} ulp off in {:g} random states, {} a call{}.", symbol(q),
                                      of(q, chosen.variant, "ulp_worst"), of(q, chosen.variant, "states"), time_text(time),
                                      beside));
    }
    return sentences;
  }

  // Against the fastest other program of each quantity; empty: there is none.
  std::string against_peers() const {
    struct Best {
      std::string quantity;
      const Peer* peer;
      double times;
    };
    std::vector<Best> list;
    for (const Row& chosen : rows_) {
      if (chosen.metric != "chosen" || chosen.quantity == "all") continue;
      const Peer* fastest = nullptr;
      double times = 0;
      for (const Peer& peer : peers) {
        const double own = of(chosen.quantity, chosen.variant, peer.metric);
        if (own > 0 && (!fastest || own < times)) fastest = &peer, times = own;
      }
      if (fastest) list.push_back({symbol(chosen.quantity), fastest, times});
    }
    if (list.empty()) return "";
    const auto [least, most] =
        std::minmax_element(list.begin(), list.end(), [](const Best& a, const Best& b) { return a.times < b.times; });
    std::vector<std::string> names;
    for (const Peer& peer : peers)
      if (std::any_of(list.begin(), list.end(), [&](const Best& b) { return b.peer == &peer; })) names.emplace_back(peer.name);
    if (list.size() == 1)
      return fmt::format("{:.3g} times as fast as {} ({}).", least->times, least->peer->name, least->quantity);
    return fmt::format("{:.3g} ({}) to {:.3g} ({}) times as fast as {}{}.", least->times, least->quantity, most->times,
                       most->quantity, names.size() > 1 ? "the faster of " : "", fmt::join(names, " and "));
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
  struct Peer {
    const char *name, *metric;
  };
  static constexpr Peer peers[] = {{pinocchio_variant, "times_faster_than_pinocchio"},
                                   {mujoco_variant, "times_faster_than_mujoco"}};
  static std::string symbol(const std::string& quantity) {
    const auto known = ir::quantity_named(quantity);
    return known ? ir::row_of(*known).symbol : quantity;
  }
  double of(const std::string& quantity, const std::string& variant, const char* metric) const {
    for (const Row& row : rows_)
      if (row.section == "rounding" && row.quantity == quantity && row.variant == variant && row.metric == metric)
        return number(row);
    return 0;  // no such row
  }

  const std::vector<Row>& rows_;
};

}  // namespace

// What goes badly first. The metric tells the page what to make of a sentence.
bool add_verdict(Rows& rows) {
  const Verdict verdict(rows);
  const std::string peers = verdict.against_peers(), weakest = verdict.weakest(), changed = verdict.changed_by_tasks();
  const std::vector<std::string> quantities = verdict.quantities();
  const auto add = [&](const char* metric, const std::string& sentence) {
    if (!sentence.empty()) rows.text("verdict", "", "", "", metric, sentence);
  };
  struct Scalar {
    const char* name;
    std::vector<std::string> failures;
  };
  const Scalar scalars[] = {{"double", verdict.failures("generated double")}, {"float", verdict.failures("generated float")}};
  add("goes_badly", changed);
  for (const Scalar& scalar : scalars)
    if (!scalar.failures.empty())
      add("goes_badly", fmt::format("Goes badly in {}: {}.", scalar.name, fmt::join(scalar.failures, "; ")));
  add("beside_peers", peers);
  for (const Scalar& scalar : scalars)
    if (scalar.failures.empty()) add("goes_well", fmt::format("No case goes badly in {}.", scalar.name));
  add("weakest", weakest);
  for (const std::string& sentence : quantities) add("of_a_quantity", sentence);
  return scalars[0].failures.empty() && changed.empty();
}

}  // namespace dalembert::reporting
