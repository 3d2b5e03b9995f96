#include "backend/target.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace dalembert::backend {

std::string Target::type() const { return fmt::format("dalembert::Lanes<Scalar, {}>", width_); }

std::string Target::load(const std::string& from) const { return fmt::format("dalembert::load<{}>({})", width_, from); }

std::string Target::store(const std::string& to) const { return fmt::format("dalembert::store<{}, Scalar>({}, ", width_, to); }

std::string Target::store_constant(const std::string& to) const { return store(to) + constant(); }

std::string Target::store_column(const std::string& to) const { return store(to) + "dalembert::computed("; }

std::string Target::constant() const { return fmt::format("dalembert::broadcast<{}, Scalar>(", width_); }

std::string Target::broadcast(const std::string& value) const { return constant() + value + ")"; }

std::string Target::gather(const std::string& from, const std::string& at) const {
  return fmt::format("dalembert::gather<{}>({}, {})", width_, from, at);
}

std::string Target::numbers(const std::vector<std::string>& literals) const {
  return fmt::format("{}{{{}}}", type(), fmt::join(literals, ", "));
}

}  // namespace dalembert::backend
