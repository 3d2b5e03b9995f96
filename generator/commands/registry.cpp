#include "commands/registry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

#include "commands/json.hpp"
#include "frontend/scene_reader.hpp"
#include "ir/aliases.hpp"
#include "ir/quantity.hpp"

namespace dalembert {

std::string registry_text() {
  std::string text;
  for (const ir::QuantityRow& row : ir::quantities())
    text += fmt::format("{:<34}{:<10}{:<34}{}\n", row.name, row.symbol, row.unit, row.help);
  text += "\nof links, named QUANTITY_LINK:\n";
  for (const ir::LinkQuantityRow& row : ir::link_quantities())
    text += fmt::format("{:<34}{:<10}{:<34}{}\n", row.name, "", row.unit, row.help);
  return text;
}

std::string registry_json() {
  std::vector<std::string> quantities, of_links;
  for (const ir::QuantityRow& row : ir::quantities()) {
    const ir::FunctionRow& function = ir::row_of(row.function);
    quantities.push_back(
        fmt::format("\n    {{\"name\": {}, \"symbol\": {}, \"function\": {}, \"takes\": {}, \"unit\": {}, \"by_default\": {}, "
                    "\"help\": {}}}",
                    json_string(row.name), json_string(row.symbol), json_string(function.name), json_string(function.input),
                    json_string(row.unit), row.by_default, json_string(row.help)));
  }
  for (const ir::LinkQuantityRow& row : ir::link_quantities())
    of_links.push_back(fmt::format("\n    {{\"name\": {}, \"unit\": {}, \"by_default\": {}, \"help\": {}}}",
                                   json_string(row.name), json_string(row.unit), row.by_default, json_string(row.help)));
  std::vector<std::string> aliases;
  for (const ir::Alias& alias : ir::quantity_aliases())
    aliases.push_back(fmt::format("{}: {}", json_string(alias.alias), json_string(alias.name)));
  return fmt::format(
      "{{\n  \"quantities\": [{}],\n  \"link_quantities\": [{}],\n  \"aliases\": {{{}}},\n  \"scene_keys\": {}\n}}\n",
      fmt::join(quantities, ", "), fmt::join(of_links, ", "), fmt::join(aliases, ", "), json_array(frontend::scene_keys()));
}

}  // namespace dalembert
