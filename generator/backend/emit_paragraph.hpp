// One paragraph of the rolled form as a loop in C++.
#pragma once

#include <string>
#include <string_view>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Statements of the paragraph over the slots of segment `segment`, inside a function that has `Workspace& workspace`.
std::string paragraph_text(const CodeInput& code, size_t segment, const ir::Paragraph& paragraph);

// The tables of constants the segment's paragraphs read.
std::string segment_tables(const CodeInput& code, size_t segment);

// `kept.role[component]`, or `kept.role(component)` where another role's place is used: one value per slot.
std::string kept(const CodeInput& code, int role, int component);
std::string kept(const CodeInput& code, std::string_view role, int component);

// The slot of a body, or of the root (-1).
int slot_of(const CodeInput& code, int body);

}  // namespace dalembert::backend
