// The text of values in lanes: loads, stores, gathers and sums in the words of runtime/include/dalembert/lanes.hpp, or of a
// single number.
#pragma once

#include <string>
#include <vector>

namespace dalembert::backend {

// Lanes over limbs: `width` values side by side, a number or a constant of the runtime.
class Target {
 public:
  explicit Target(std::string width) : width_(std::move(width)) {}

  const std::string& width() const { return width_; }
  std::string type() const;                                                  // of a variable
  std::string load(const std::string& from) const;                           // of consecutive numbers
  std::string store(const std::string& to) const;                            // up to the value; ");" follows
  std::string store_constant(const std::string& to) const;                   // … which is one number; "));" follows
  std::string store_column(const std::string& to) const;                     // … which is a table's; "));" follows
  std::string broadcast(const std::string& value) const;                     // one number in all lanes
  std::string constant() const;                                              // the same of what follows; ")" follows that
  std::string gather(const std::string& from, const std::string& at) const;  // from[at[lane]]
  std::string numbers(const std::vector<std::string>& literals) const;       // one per lane, not all equal

 private:
  std::string width_;
};

}  // namespace dalembert::backend
