#include "commands/finite_inputs.hpp"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "commands/generic_engine.hpp"

namespace dalembert {

namespace {

// One number of a state.
struct Entry {
  const char* name;
  Eigen::VectorXd State::*part;
  Eigen::Index index;
  Eigen::Index place;  // on the line, counted from 1

  double& of(State& state) const { return (state.*part)[index]; }
};

std::vector<Entry> not_finite(const State& state, const char* input) {
  std::vector<Entry> entries;
  Eigen::Index place = 0;
  for (const auto& [name, part] :
       {std::pair{"q", &State::q}, {"v", &State::v}, {input, &State::more}, {"wrenches", &State::wrenches}})
    for (Eigen::Index i = 0; i < (state.*part).size(); ++i) {
      ++place;
      if (!std::isfinite((state.*part)[i])) entries.push_back({name, part, i, place});
    }
  return entries;
}

}  // namespace

void check_finite_inputs(const Model& model, const Output& output, const std::string& state_file, const State& state,
                         bool result_is_finite) {
  const std::vector<Entry> entries = not_finite(state, ir::row_of(output.function.inputs).input);
  if (entries.empty()) return;
  const auto refuse_if = [&](const Entry& entry, bool counts) {
    State given = state;
    if (counts)
      throw InputError({Severity::error, state_file, state.place,
                        fmt::format("number {}, {}[{}], is {}, and {} depends on it", entry.place, entry.name, entry.index,
                                    entry.of(given), output.name),
                        "give a finite number; 'dalembert info' lists the coordinates"});
  };
  const auto result = [&](State other) {
    for (const int first : model.tree.quaternions())
      if (other.q.segment<4>(first).allFinite()) other.q.segment<4>(first).normalize();
    return evaluate_generic(model, output, other);
  };
  // What does not count all the same moves the last digits: on a fixed base the first joint turns the frame of reference.
  const auto is_same = [](const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() <= 1e-9 * a.cwiseAbs().maxCoeff();
  };
  State finite = state, all_others = state;
  for (const Entry& entry : entries) {
    entry.of(finite) = 0.3;
    entry.of(all_others) = 0.7 + 0.1 * static_cast<double>(entry.place % 5);
  }
  const auto with = [&](const Entry& entry, State other) {
    State one = finite;
    entry.of(one) = entry.of(other);
    return result(one);
  };
  const Eigen::MatrixXd usual = result(finite);
  if (!is_same(usual, result(all_others)))
    for (const Entry& entry : entries) refuse_if(entry, !is_same(usual, with(entry, all_others)));
  if (result_is_finite) return;  // otherwise it counts for nothing, as in 0 · nan
  for (const Entry& entry : entries) refuse_if(entry, !with(entry, state).allFinite());
  refuse_if(entries.front(), true);
}

}  // namespace dalembert
