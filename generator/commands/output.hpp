// One result a user can name: a quantity, or one of a link.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "ir/emitted_function.hpp"
#include "pipeline.hpp"

namespace dalembert {

struct Output {
  std::string name;  // "mass_matrix", "jacobian_left_foot", "balance_mass_matrix"
  std::optional<ir::Quantity> quantity;
  std::string link;  // of a link's quantity
  ir::LinkQuantity of_link = ir::LinkQuantity::jacobian;
  int rows = 0;
  int columns = 1;
  ir::EmittedFunction function{};  // that computes it; of a standard one without its quantities
  std::optional<ir::Part> part{};  // of the result, where it is not wanted whole

  // What its rows and columns are, and the word for all that is computed like it: mass_matrix, jacobian.
  std::pair<ir::Extent, ir::Extent> axes() const;
  const char* registered() const;
  ir::Selection selection() const;
};

// The output of that name: a quantity's, that of a link's quantity and the link's, or of one of the scene's functions and its
// quantity. Throws InputError when the model has none such.
Output output_named(const Model& model, const std::string& name);

// The outputs the scene asks for.
std::vector<Output> outputs_of(const Model& model);

// The same model with these outputs and no others, without a task graph. A function that the scene names computes all of its
// quantities where one is asked for: that is the call that gives it.
Model with_outputs(Model model, const std::vector<Output>& outputs);

}  // namespace dalembert
