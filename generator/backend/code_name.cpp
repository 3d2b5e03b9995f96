#include "backend/code_name.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace dalembert::backend {

std::string hash_of(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

namespace {

void replace_all(std::string& text, std::string_view what, std::string_view by) {
  for (size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size())) text.replace(at, what.size(), by);
}

std::string_view name_in(std::string_view text) {
  constexpr std::string_view before = "\ninline namespace ";
  const size_t at = text.find(before);
  return at == text.npos ? "" : text.substr(at + before.size(), text.find(' ', at + before.size()) - at - before.size());
}

}  // namespace

void name_by_content(std::vector<OutputFile>& files, std::string_view content) {
  const std::string name = "code_" + hash_of(content).substr(0, 8);
  for (OutputFile& file : files) replace_all(file.text, code_mark, name);
}

std::string named_as(std::string text, std::string_view other) {
  const std::string from(name_in(text)), to(name_in(other));
  if (!from.empty() && !to.empty() && from != to) replace_all(text, from, to);
  return text;
}

}  // namespace dalembert::backend
