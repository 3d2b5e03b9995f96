// Where the rolled form keeps values: names of arrays and places in them.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// `scratch.role[component]`, or `scratch.role(component)` where another role's array is used: one value per slot.
std::string kept(const CodeInput& code, int role, int component);
// The number at a fixed slot: `scratch.role[component][slot]`.
std::string number(const CodeInput& code, const ir::Address& address);
// Whether the role is kept at all.
bool is_kept(const CodeInput& code, int role);

// The slot of a body, or of the base (−1).
int slot_of(const CodeInput& code, int body);
// The same as the text has it: the base's by name.
std::string slot_text(const CodeInput& code, int body);
// From one component of an array to the next, with room for the base's slot and to read past the last.
int stride(const CodeInput& code);

int base_rows(const CodeInput& code);       // 6 or 0
int base_positions(const CodeInput& code);  // 7 or 0
// Whether a joint is driven by another: rows of bodies and rows of results are then two things.
int driven_joints(const CodeInput& code);
bool has_driven(const CodeInput& code);
// Rows of matrices if driven joints had rows of their own.
int expanded_rows(const CodeInput& code);

// The definition of the struct that `scratch` is, and its arrays' size in bytes.
std::string kept_definition(const CodeInput& code);
std::size_t kept_bytes(const CodeInput& code);

}  // namespace dalembert::backend
