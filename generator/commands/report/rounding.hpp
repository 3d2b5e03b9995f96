// Error against time: every output by itself, by every variant and by the generic engine.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "commands/report/rows.hpp"
#include "commands/report/subject.hpp"
#include "commands/report/variants.hpp"

namespace dalembert::reporting {

class Rounding {
 public:
  explicit Rounding(const Subject& subject);

  // What is to be compiled.
  std::vector<Order> orders() const;

  // Rows of section `rounding`, by the engines that were ordered: per output and variant the time per call (median, quartiles),
  // the error at random states (norm-wise with quartiles and worst, in ulp, component-wise), and whether the variant is on the
  // Pareto front of median time and worst error: nobody is both faster and more exact.
  void add(std::span<const std::unique_ptr<GeneratedEngine>> engines, Rows& rows) const;

 private:
  const Subject& subject_;
  std::vector<std::vector<Variant>> ways_;  // per output
  std::vector<std::string> chosen_;         // of those, what users get
};

inline constexpr const char* random_case = "random states";
inline constexpr const char* generic_variant = "generic double";

}  // namespace dalembert::reporting
