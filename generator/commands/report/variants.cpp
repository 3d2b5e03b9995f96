#include "commands/report/variants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "commands/parallel.hpp"
#include "commands/report/progress.hpp"

namespace dalembert::reporting {
namespace {

Variant variant(ir::Form form, ir::ScalarType scalar, int lanes, bool fused, bool library_sines = false) {
  std::string name = form == ir::Form::rolled ? "rolled" : "straight";
  name += scalar == ir::ScalarType::float32 ? " float" : " double";
  if (lanes > 0) name += lanes == 1 ? ", 1 lane" : fmt::format(", {} lanes", lanes);
  if (!fused) name += ", not fused";
  if (library_sines) name += ", library sines";
  return {name, form, scalar, lanes, fused, library_sines};
}

}  // namespace

std::vector<Variant> variants(ir::Form chosen, bool quick) {
  using enum ir::ScalarType;
  std::vector<Variant> list;
  for (ir::Form form : {ir::Form::straight, ir::Form::rolled})
    for (ir::ScalarType scalar : {float64, float32})
      if (!quick || scalar == float64 || form == chosen) list.push_back(variant(form, scalar, 0, true));
  if (!quick)
    for (ir::ScalarType scalar : {float64, float32})
      for (int lanes : {1, 2, 4, 8}) list.push_back(variant(ir::Form::rolled, scalar, lanes, true));
  for (ir::ScalarType scalar : {float64, float32})
    if (!quick || scalar == float64) list.push_back(variant(chosen, scalar, 0, false));
  list.push_back(variant(chosen, float64, 0, true, true));
  return list;
}

const Variant& plain(const std::vector<Variant>& variants, ir::Form chosen, ir::ScalarType scalar) {
  const auto at = std::find_if(variants.begin(), variants.end(), [&](const Variant& v) {
    return v.form == chosen && v.scalar == scalar && v.lanes == 0 && v.fused && !v.library_sines;
  });
  if (at == variants.end()) throw std::logic_error("no plain variant");
  return *at;
}

Model model_of(Model model, const Variant& variant) {
  model.options.form = variant.form;
  model.scene.scalar = variant.scalar;
  return model;
}

CompilerOptions options_of(CompilerOptions options, const Variant& variant) {
  options.lanes = variant.lanes;
  if (!variant.fused) {
    options.flags += " -ffp-contract=off";
    options.precompiled.clear();  // made with other flags
  }
  if (variant.library_sines) options.flags += " -DDALEMBERT_LIBRARY_SINES";
  return options;
}

Engines make_engines(const std::vector<Order>& orders, const std::vector<std::function<void()>>& besides) {
  Engines engines(orders.size());
  const size_t count = besides.size() + orders.size();
  Progress progress("compiling", count);
  each_in_parallel(count, [&](size_t i) {
    if (i < besides.size()) {
      besides[i]();
    } else {
      const Order& order = orders[i - besides.size()];
      engines[i - besides.size()] = std::make_unique<GeneratedEngine>(order.model, order.outputs, order.options);
    }
    progress.step();
  });
  return engines;
}

}  // namespace dalembert::reporting
