// The ways a model can be generated and compiled that a report sets side by side.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "commands/compiler.hpp"
#include "commands/generated_engine.hpp"
#include "pipeline.hpp"

namespace dalembert::reporting {

struct Variant {
  std::string name;  // "rolled double, 4 lanes"
  ir::Form form = ir::Form::automatic;
  ir::ScalarType scalar = ir::ScalarType::float64;
  int lanes = 0;      // 0: as many as the target's registers hold
  bool fused = true;  // products and sums may be fused (fma)
  bool library_sines = false;
};

// `chosen`: the form the compiler takes of its own accord. All: both forms in double and float, loops in 1 to 8 lanes, and the
// chosen form without fused operations and with the library's sines. Quick: both forms in double; the chosen one in float,
// without fused operations and with the library's sines.
std::vector<Variant> variants(ir::Form chosen, bool quick);

// The chosen form in the scalar, otherwise as users get it: a variant of the list above.
const Variant& plain(const std::vector<Variant>& variants, ir::Form chosen, ir::ScalarType scalar);

// The model in the variant's form and scalar, and how it is compiled.
Model model_of(Model model, const Variant& variant);
CompilerOptions options_of(CompilerOptions options, const Variant& variant);

// Engines to be made: several at a time, since compiling takes nearly all of a report's time.
struct Order {
  Model model;
  std::vector<Output> outputs;
  CompilerOptions options;
};

using Engines = std::vector<std::unique_ptr<GeneratedEngine>>;

// In the orders' order; says on stderr how far it is. What takes longest comes first, so that no core waits long at the end:
// `besides` is done before them all.
Engines make_engines(const std::vector<Order>& orders, const std::vector<std::function<void()>>& besides = {});

}  // namespace dalembert::reporting
