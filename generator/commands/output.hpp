// One result a user can name: a quantity, or one of a link.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline.hpp"

namespace dalembert {

struct Output {
  std::string name;  // "mass_matrix", "jacobian_left_foot"
  std::optional<ir::Quantity> quantity;
  std::string link;  // of a link's quantity
  ir::LinkQuantity of_link = ir::LinkQuantity::jacobian;
  int rows = 0;
  int columns = 1;

  // The function that computes it.
  ir::Function function() const { return quantity ? ir::row_of(*quantity).function : ir::Function::evaluate; }
};

// The output of that name: a quantity's, or that of a link's quantity and the link's. Throws InputError when the model has none
// such.
Output output_named(const Model& model, const std::string& name);

// The outputs the scene asks for.
std::vector<Output> outputs_of(const Model& model);

// The same model with these outputs and no others, without a task graph.
Model with_outputs(Model model, const std::vector<Output>& outputs);

}  // namespace dalembert
