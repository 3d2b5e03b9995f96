#include "ir/identifier.hpp"

#include <algorithm>
#include <iterator>

namespace dalembert::ir {

namespace {
bool is_digit(char c) { return '0' <= c && c <= '9'; }
bool is_letter(char c) { return ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || c == '_'; }

// Sorted, for binary search.
constexpr std::string_view keywords[] = {
    // of g++ and clang++ besides, as they compile by default
    "_Accum", "_Alignas", "_Alignof", "_Atomic", "_BitInt", "_Bool", "_Complex", "_Decimal128", "_Decimal32", "_Decimal64",
    "_ExtInt", "_Float128", "_Float16", "_Float32", "_Float32x", "_Float64", "_Float64x", "_Fract", "_Generic", "_Imaginary",
    "_Nonnull", "_Noreturn", "_Null_unspecified", "_Nullable", "_Nullable_result", "_Pragma", "_Sat", "_Static_assert",
    "_Thread_local",
    // of the language
    "alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch", "char",
    "char16_t", "char32_t", "char8_t", "class", "co_await", "co_return", "co_yield", "compl", "concept", "const", "const_cast",
    "consteval", "constexpr", "constinit", "continue", "decltype", "default", "delete", "do", "double", "dynamic_cast", "else",
    "enum", "explicit", "export", "extern", "false", "float", "for", "friend", "goto", "if", "inline", "int", "long", "mutable",
    "namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or", "or_eq", "private", "protected", "public",
    "register", "reinterpret_cast", "requires", "return", "short", "signed", "sizeof", "static", "static_assert", "static_cast",
    "struct", "switch", "template", "this", "thread_local", "throw", "true", "try", "typedef", "typeid", "typename", "typeof",
    "union", "unsigned", "using", "virtual", "void", "volatile", "wchar_t", "while", "xor", "xor_eq"};
}  // namespace

std::string identifier(std::string_view name) {
  std::string text;
  text.reserve(name.size() + 1);
  if (name.empty() || is_digit(name.front())) text += '_';
  for (char c : name) text += is_letter(c) || is_digit(c) ? c : '_';
  return text;
}

bool is_cpp_keyword(std::string_view text) { return std::binary_search(std::begin(keywords), std::end(keywords), text); }

}  // namespace dalembert::ir
