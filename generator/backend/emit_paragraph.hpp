// One paragraph of the rolled form as a loop in C++.
#pragma once

#include <string>

#include "backend/emit.hpp"

namespace dalembert::backend {

// Statements of the paragraph over the slots of segment `segment`, inside a function that has `scratch` (kept.hpp).
std::string paragraph_text(const CodeInput& code, size_t segment, const ir::Paragraph& paragraph);

// The tables of constants the segment's paragraphs read.
std::string segment_tables(const CodeInput& code, size_t segment);

}  // namespace dalembert::backend
