// What else quantities are called: where users name one, the field's name stands for ours.
#pragma once

#include <string>
#include <vector>

namespace dalembert::ir {

struct Alias {
  const char *alias, *name;
};
const std::vector<Alias>& quantity_aliases();
const std::vector<Alias>& link_quantity_aliases();
// What they stand for left out.
std::vector<std::string> names_of(const std::vector<Alias>& aliases);

// The name itself where it is no alias.
std::string named_by_us(const std::string& name, const std::vector<Alias>& aliases);

}  // namespace dalembert::ir
