// How a scene and `info` call the types of contacts and loops.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ir/contact.hpp"
#include "ir/loop.hpp"

namespace dalembert::ir {

inline const std::vector<std::pair<std::string, ContactType>>& contact_words() {
  static const std::vector<std::pair<std::string, ContactType>> words{{"weld", ContactType::weld},
                                                                      {"point", ContactType::point}};
  return words;
}
inline const std::vector<std::pair<std::string, LoopType>>& loop_words() {
  static const std::vector<std::pair<std::string, LoopType>> words{
      {"point", LoopType::point},   {"weld", LoopType::weld}, {"hinge", LoopType::hinge},      {"cylinder", LoopType::cylinder},
      {"planar", LoopType::planar}, {"pin", LoopType::pin},   {"distance", LoopType::distance}};
  return words;
}

}  // namespace dalembert::ir
