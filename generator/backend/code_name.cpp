#include "backend/code_name.hpp"

#include <fmt/format.h>

#include <cstdint>

namespace dalembert::backend {

std::string hash_of(std::string_view bytes) {
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char byte : bytes) hash = (hash ^ static_cast<unsigned char>(byte)) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

void name_by_content(std::vector<OutputFile>& files, std::string_view content) {
  const std::string name = "code_" + hash_of(content).substr(0, 8), mark = code_mark;
  for (OutputFile& file : files)
    for (size_t at = file.text.find(mark); at != std::string::npos; at = file.text.find(mark, at + name.size()))
      file.text.replace(at, mark.size(), name);
}

}  // namespace dalembert::backend
