#include "backend/output_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "diagnostics.hpp"

namespace dalembert::backend {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, std::string message) {
  throw InputError({Severity::error, path.string(), "", std::move(message), "name a folder that can be written with -o"});
}

bool holds(const fs::path& path, const std::string& text) {
  std::ifstream file(path, std::ios::binary);
  return file && std::equal(std::istreambuf_iterator<char>(file), {}, text.begin(), text.end());
}

void replace(const fs::path& path, const std::string& text) {
  const fs::path temporary = path.string() + ".new" + std::to_string(getpid());
  std::error_code error;
  {
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file << text;
    file.close();
    if (file) fs::rename(temporary, path, error);
    else error = std::make_error_code(std::errc::io_error);
  }
  if (!error) return;
  std::error_code ignored;
  fs::remove(temporary, ignored);
  refuse(path, "the file cannot be written");
}

bool is_ours(const fs::path& path) {
  std::string start(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return start.find(banner_mark) != start.npos;
}

}  // namespace

void write_files(const std::string& folder, const std::vector<OutputFile>& files) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) refuse(folder, "the folder cannot be made");
  for (const OutputFile& file : files)
    if (const fs::path path = fs::path(folder) / file.name; !holds(path, file.text)) replace(path, file.text);
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error)) {
    const bool produced =
        std::any_of(files.begin(), files.end(), [&](const OutputFile& f) { return entry.path().filename() == f.name; });
    if (!produced && entry.is_regular_file(error) && is_ours(entry.path())) fs::remove(entry.path(), error);
  }
}

}  // namespace dalembert::backend
