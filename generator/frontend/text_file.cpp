#include "frontend/text_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>

#include "diagnostics.hpp"

namespace dalembert::frontend {

std::string read_text_file(const std::string& path, const std::string& kind, size_t limit) {
  const auto refuse = [&](std::string message, std::string remedy) -> void {
    throw InputError({Severity::error, path, "", std::move(message), std::move(remedy)});
  };
  const std::string name_one = fmt::format("name a {} file that can be read", kind);
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status)) refuse("there is no such file", name_one);
  if (std::filesystem::is_directory(status)) refuse("this is a directory", name_one);
  std::ifstream file(path, std::ios::binary);
  std::string text;
  for (char piece[1 << 16]; file && text.size() <= limit;) {
    file.read(piece, sizeof piece);
    text.append(piece, static_cast<size_t>(file.gcount()));
  }
  if (!file.is_open() || file.bad()) refuse("the file cannot be read", name_one);
  if (text.size() > limit)
    refuse(fmt::format("the file is longer than {} MiB", limit >> 20), fmt::format("a {} is shorter: name another file", kind));
  return text;
}

}  // namespace dalembert::frontend
