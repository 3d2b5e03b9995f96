#include "frontend/text_file.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <string_view>
#include <utility>

#include "diagnostics.hpp"

namespace dalembert::frontend {

namespace {

[[noreturn]] void refuse(const std::string& path, std::string message, std::string remedy) {
  throw InputError({Severity::error, path, "", std::move(message), std::move(remedy)});
}

std::string name_one(const std::string& kind) { return fmt::format("name a {} file that can be read", kind); }

std::ifstream opened(const std::string& path, const std::string& kind) {
  std::error_code ignored;
  const std::filesystem::file_status status = std::filesystem::status(path, ignored);
  if (!std::filesystem::exists(status)) refuse(path, "there is no such file", name_one(kind));
  if (std::filesystem::is_directory(status)) refuse(path, "this is a directory", name_one(kind));
  std::ifstream file(path, std::ios::binary);
  if (!file.is_open()) refuse(path, "the file cannot be read", name_one(kind));
  return file;
}

std::string read(std::istream& stream, const std::string& name, const std::string& kind, size_t limit, bool zeros) {
  std::string text;
  for (char piece[1 << 16]; stream && text.size() <= limit;) {
    stream.read(piece, sizeof piece);
    const std::string_view read(piece, static_cast<size_t>(stream.gcount()));
    if (const size_t zero = read.find('\0'); !zeros && zero != read.npos)
      refuse(name, fmt::format("byte {} is zero: this is no text", text.size() + zero + 1), name_one(kind));
    text.append(read);
  }
  if (stream.bad()) refuse(name, "the file cannot be read", name_one(kind));
  if (text.size() > limit)
    refuse(name, fmt::format("the file is longer than {} MiB", limit >> 20),
           fmt::format("a {} is shorter: name another file", kind));
  return text;
}

}  // namespace

std::string read_text_file(const std::string& path, const std::string& kind, size_t limit) {
  std::ifstream file = opened(path, kind);
  return read(file, path, kind, limit, true);
}

std::string read_lines(const std::string& path, const std::string& kind, size_t limit) {
  if (path == "-") return read(std::cin, "standard input", kind, limit, false);
  std::ifstream file = opened(path, kind);
  return read(file, path, kind, limit, false);
}

}  // namespace dalembert::frontend
