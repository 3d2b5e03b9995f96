#include "backend/workspace_size.hpp"

#include "backend/emit_rolled.hpp"

namespace dalembert::backend {

std::size_t workspace_bytes(const CodeInput& code) {
  const std::size_t scalar = code.scene.scalar == ir::ScalarType::float32 ? 4 : 8;
  std::size_t bytes = 0;
  const auto align = [&] { bytes = (bytes + 63) / 64 * 64; };
  const auto array = [&](int rows, int columns) {
    align();
    bytes += scalar * static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  };
  for (const ir::OutputArray& a : code.program.arrays) array(a.rows, a.columns);
  if (code.scene.gravity_kind == ir::GravityKind::run_time) bytes += 3 * scalar;
  bytes += code.scene.payloads.size() * 10 * scalar;  // mass, centre of mass, inertia
  if (code.plan.form == ir::Form::rolled)
    for (const KeptArray& kept : kept_arrays(code)) array(kept.components, kept.slots);
  align();
  return bytes;
}

}  // namespace dalembert::backend
