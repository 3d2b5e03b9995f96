#include "backend/code_text.hpp"

#include <fmt/format.h>

#include <stdexcept>

#include "ir/identifier.hpp"

namespace dalembert::backend {

std::string input_text(const CodeInput& code, const ir::Input& input) {
  switch (input.kind) {
    case ir::InputKind::position: return fmt::format("q[{}]", input.index);
    case ir::InputKind::velocity: return fmt::format("v[{}]", input.index);
    case ir::InputKind::gravity: return fmt::format("workspace.gravity_vector[{}]", input.component);
    case ir::InputKind::payload: {
      const std::string payload =
          "workspace.payload_" + ir::identifier(code.scene.payloads.at(static_cast<size_t>(input.index)));
      if (input.component == 0) return payload + ".mass";
      if (input.component < 4) return fmt::format("{}.com[{}]", payload, input.component - 1);
      return fmt::format("{}.inertia[{}]", payload, input.component - 4);
    }
    default: throw std::logic_error("an input of a loop outside a loop");
  }
}

int element_index(const ir::OutputArray& array, int row, int column) { return row + array.rows * column; }

}  // namespace dalembert::backend
