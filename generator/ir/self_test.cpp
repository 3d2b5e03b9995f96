#include "ir/self_test.hpp"

#include <stdexcept>

namespace dalembert::ir {

std::vector<double> SelfTest::given(const RunTimeInput& input) const {
  const auto index = static_cast<size_t>(input.index);
  switch (input.kind) {
    case InputKind::gravity: return {gravity[0], gravity[1], gravity[2]};
    case InputKind::wrench: return {wrenches.begin() + 6 * input.index, wrenches.begin() + 6 * (input.index + 1)};
    case InputKind::payload: {
      const auto& [mass, com, inertia] = payloads[index];
      return {mass,          com[0],        com[1],        com[2],        inertia(0, 0),
              inertia(0, 1), inertia(0, 2), inertia(1, 1), inertia(1, 2), inertia(2, 2)};
    }
    default: throw std::logic_error("no input of each state");
  }
}

}  // namespace dalembert::ir
