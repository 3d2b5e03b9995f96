#include "backend/kept.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "backend/code_text.hpp"
#include "backend/emit_prepare.hpp"
#include "backend/literals.hpp"

namespace dalembert::backend {
namespace {

std::size_t scalar_bytes(const CodeInput& code) { return code.scene.scalar == ir::ScalarType::float32 ? 4 : 8; }

struct Array {
  std::string name;
  int components, slots;
  std::string meaning;
};

std::vector<Array> arrays(const CodeInput& code) {
  std::vector<Array> all;
  if (needs_angles(code)) all.push_back({"angle", 1, stride(code), "q of turning joints, rad"});
  for (const ir::KeptArray& a : code.rolled.arrays) all.push_back({a.name, a.components, stride(code), a.meaning});
  for (const ir::Pairs& p : code.algorithm.pairs)
    if (has_driven(code))
      all.push_back({"mimic_" + code.algorithm.arrays[static_cast<size_t>(p.array)].name, 2 * driven_joints(code),
                     expanded_rows(code), "columns of mimic joints, then their rows"});
  return all;
}

}  // namespace

std::string kept(const CodeInput& code, int role, int component) {
  const ir::Place& place = code.rolled.places.at(static_cast<size_t>(role));
  const std::string &array = code.rolled.arrays.at(static_cast<size_t>(place.array)).name,
                    &own = code.rolled.roles[static_cast<size_t>(role)].name;
  return array == own ? fmt::format("scratch.{}[{}]", array, place.from + component)
                      : fmt::format("scratch.{}({})", own, component);
}

std::string number(const CodeInput& code, const ir::Address& address) {
  return fmt::format("{}[{}]", kept(code, address.role, address.component), slot_text(code, address.body));
}

bool is_kept(const CodeInput& code, int role) { return code.rolled.is_kept(role); }

int slot_of(const CodeInput& code, int body) { return code.plan.slot(body); }

std::string slot_text(const CodeInput& code, int body) { return body < 0 ? "base_slot" : std::to_string(slot_of(code, body)); }

// Components that are a multiple of 1 kB apart would share the same few lines of a cache.
int stride(const CodeInput& code) {
  const int numbers = code.plan.slots + 8, line = 64 / static_cast<int>(scalar_bytes(code));
  return numbers % (16 * line) == 0 ? numbers + line : numbers;
}

int base_rows(const CodeInput& code) { return code.tree.base_coordinates(); }
int base_positions(const CodeInput& code) { return code.tree.base_positions(); }

int driven_joints(const CodeInput& code) { return code.tree.joints() - code.tree.independent_joints(); }
bool has_driven(const CodeInput& code) { return driven_joints(code) > 0; }

int expanded_rows(const CodeInput& code) { return base_rows(code) + code.tree.joints(); }

std::string kept_definition(const CodeInput& code) {
  std::string text =
      fmt::format("  // One value per slot, a slot per body of a branch and lane, and one of the base.\n  struct {} {{\n",
                  own_type(code, "Scratch"));
  for (const Array& a : arrays(code))
    text += with_comment(fmt::format("    alignas(64) Scalar {}[{}][{}] = {{}};", a.name, a.components, a.slots), a.meaning);
  for (size_t r = 0; r < code.rolled.roles.size(); ++r) {
    const ir::Place& place = code.rolled.places[r];
    const ir::Role& role = code.rolled.roles[r];
    if (place.array < 0) continue;
    const std::string& array = code.rolled.arrays[static_cast<size_t>(place.array)].name;
    if (array == role.name) continue;
    text += with_comment(fmt::format("    Scalar* {}(int i) noexcept {{ return {}[{}i]; }}", role.name, array,
                                     place.from > 0 ? fmt::format("{} + ", place.from) : ""),
                         role.meaning + (role.unit.empty() ? "" : ", " + role.unit));
  }
  return text + "  };\n";
}

std::size_t kept_bytes(const CodeInput& code) {
  const std::size_t scalar = scalar_bytes(code);
  std::size_t bytes = 0;
  for (const Array& a : arrays(code)) {
    bytes = (bytes + 63) / 64 * 64;
    bytes += scalar * static_cast<std::size_t>(a.components) * static_cast<std::size_t>(a.slots);
  }
  return bytes;
}

}  // namespace dalembert::backend
