// How a scene's `plan` and `info` call the ways to compute a function.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ir/scene.hpp"

namespace dalembert::ir {

inline const std::vector<std::pair<std::string, Form>>& form_words() {
  static const std::vector<std::pair<std::string, Form>> words{{"straight", Form::straight}, {"rolled", Form::rolled}};
  return words;
}
inline const std::vector<std::pair<std::string, Solver>>& solver_words() {
  static const std::vector<std::pair<std::string, Solver>> words{{"articulated_bodies", Solver::articulated_bodies},
                                                                 {"factorization", Solver::factorization}};
  return words;
}
inline const std::vector<std::pair<std::string, Order>>& order_words() {
  static const std::vector<std::pair<std::string, Order>> words{
      {"as_written", Order::as_written}, {"longest_first", Order::longest_first}, {"newest_first", Order::newest_first}};
  return words;
}

template <class Value>
const std::string& word_of(const std::vector<std::pair<std::string, Value>>& words, Value value) {
  for (const auto& [word, meaning] : words)
    if (meaning == value) return word;
  return words.front().first;
}

}  // namespace dalembert::ir
