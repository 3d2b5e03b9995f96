#include "ir/aliases.hpp"

#include "ir/link_quantity.hpp"
#include "ir/quantity.hpp"

namespace dalembert::ir {

// Each is looked up in its enumeration, so that a row with another name does not compile.
const std::vector<Alias>& quantity_aliases() {
  static const std::vector<Alias> aliases{
#define DALEMBERT_ALIAS(alias, ours) {#alias, row_of(Quantity::ours).name},
#define DALEMBERT_LINK_ALIAS(alias, ours)
#include "ir/aliases.def"
#undef DALEMBERT_ALIAS
#undef DALEMBERT_LINK_ALIAS
  };
  return aliases;
}

const std::vector<Alias>& link_quantity_aliases() {
  static const std::vector<Alias> aliases{
#define DALEMBERT_ALIAS(alias, ours)
#define DALEMBERT_LINK_ALIAS(alias, ours) {#alias, row_of(LinkQuantity::ours).name},
#include "ir/aliases.def"
#undef DALEMBERT_ALIAS
#undef DALEMBERT_LINK_ALIAS
  };
  return aliases;
}

std::string named_by_us(const std::string& name, const std::vector<Alias>& aliases) {
  for (const Alias& alias : aliases)
    if (name == alias.alias) return alias.name;
  return name;
}

std::vector<std::string> names_of(const std::vector<Alias>& aliases) {
  std::vector<std::string> names;
  for (const Alias& alias : aliases) names.emplace_back(alias.alias);
  return names;
}

}  // namespace dalembert::ir
