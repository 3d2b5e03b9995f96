#include "commands/state_file.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <sstream>

#include "frontend/numbers.hpp"
#include "frontend/text_file.hpp"

namespace dalembert {

namespace {

void normalise_quaternion(State& state, int first, bool of_base, const std::string& file, Diagnostics& warnings) {
  auto quaternion = state.q.segment<4>(first);
  const double length = quaternion.norm();
  if (std::isnan(length)) return;
  const std::string whose =
      of_base ? "the base's quaternion" : fmt::format("the quaternion of q[{}] to q[{}]", first, first + 3);
  if (length == 0 || std::isinf(length))
    throw InputError({Severity::error, file, state.place, fmt::format("{} has length {}", whose, length),
                      of_base ? "give a unit quaternion x y z w as the 4th to 7th number, for example 0 0 0 1"
                              : "give a unit quaternion x y z w, for example 0 0 0 1"});
  if (std::abs(length - 1) > 1e-6)
    warnings.push_back({Severity::warning, file, state.place, fmt::format("{} has length {:.9g}", whose, length),
                        "it is normalised; give a unit quaternion x y z w"});
  quaternion /= length;
}

std::string first_that_is_none(const std::string& line) {
  std::istringstream words(line);
  std::string word;
  int number = 0;
  do words >> word, ++number;
  while (words && frontend::parse_number(word));
  constexpr std::size_t most = 20;
  return fmt::format("'{}', number {}", word.substr(0, most), number);
}

}  // namespace

std::vector<State> read_states(const std::string& path, const ir::KinematicTree& tree, ir::Function function,
                               Diagnostics& warnings) {
  return read_states_text(path == "-" ? "standard input" : path, frontend::read_lines(path, "state", most_bytes_of_states),
                          tree, function, warnings);
}

std::vector<State> read_states_text(const std::string& file, const std::string& text, const ir::KinematicTree& tree,
                                    ir::Function function, Diagnostics& warnings) {
  const ir::FunctionRow& row = ir::row_of(function);
  const Eigen::Index nq = tree.nq(), nv = tree.nv(), more = *row.input ? nv : 0;
  const Eigen::Index wrenches = more > 0 ? 6 * static_cast<Eigen::Index>(tree.pushed.size()) : 0;
  const Eigen::Index count = nq + nv + more + wrenches;
  std::string last = more > 0 ? fmt::format(", then {} ({}), {}", row.input, nv, row.meaning) : "";
  if (wrenches > 0) last += fmt::format(", then the scene's wrenches ({}), force and moment of each", wrenches);
  const std::string layout = fmt::format("a state of {} is {} numbers, q ({}) then v ({}), as 'dalembert info' lists them{}",
                                         tree.robot, count, nq, nv, last);
  std::vector<State> states;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r\f\v") == line.npos) continue;
    const std::string place = fmt::format("line {}", number);
    const std::optional<std::vector<double>> values = frontend::parse_numbers(line);
    if (!values)
      throw InputError({Severity::error, file, place, "something on it is not a number: " + first_that_is_none(line), layout});
    if (static_cast<Eigen::Index>(values->size()) != count)
      throw InputError(
          {Severity::error, file, place, fmt::format("there are {} numbers instead of {}", values->size(), count), layout});
    const Eigen::Map<const Eigen::VectorXd> all(values->data(), count);
    State state{place, all.head(nq), all.segment(nq, nv), all.segment(nq + nv, more), all.tail(wrenches)};
    for (const int first : tree.quaternions())
      normalise_quaternion(state, first, tree.base_coordinates() > 0 && first == 3, file, warnings);
    states.push_back(std::move(state));
  }
  if (states.empty()) throw InputError({Severity::error, file, "", "there is no state in it", layout});
  return states;
}

}  // namespace dalembert
