#include "backend/output_files.hpp"

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>

#include "diagnostics.hpp"

namespace dalembert::backend {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& path, std::string message) {
  throw InputError({Severity::error, path.string(), "", std::move(message), "name a folder that can be written with -o"});
}

bool holds(const fs::path& path, const std::string& text) {
  std::error_code error;
  if (!fs::is_regular_file(path, error)) return false;
  std::ifstream file(path, std::ios::binary);
  return file && std::equal(std::istreambuf_iterator<char>(file), {}, text.begin(), text.end());
}

// Files under their temporary names, until all of them are renamed; those that are not, are removed.
class Staged {
 public:
  ~Staged() {
    std::error_code ignored;
    for (const auto& [temporary, path] : files_) fs::remove(temporary, ignored);
  }

  // What a link leads to is written, and keeps its permissions.
  void add(const fs::path& named, const std::string& text) {
    std::error_code error;
    fs::path path = named;
    if (fs::is_symlink(named, error)) {
      path = fs::canonical(named, error);
      if (error) refuse(named, "the link leads nowhere");
    }
    if (fs::is_directory(path, error)) refuse(path, "a folder stands in the file's place");
    const fs::file_status before = fs::status(path, error);
    if (fs::exists(before) && access(path.c_str(), W_OK) != 0) refuse(path, "the file cannot be written");
    fs::path temporary = path;
    temporary += ".new" + std::to_string(getpid());
    files_.emplace_back(temporary, path);
    std::ofstream file(temporary, std::ios::binary | std::ios::trunc);
    file << text;
    file.close();
    if (!file) refuse(path, "the file cannot be written");
    if (fs::exists(before)) fs::permissions(temporary, before.permissions(), error);
  }

  void rename() {
    std::error_code error;
    for (const auto& [temporary, path] : files_) {
      fs::rename(temporary, path, error);
      if (error) refuse(path, "the file cannot be written");
    }
    files_.clear();
  }

 private:
  std::vector<std::pair<fs::path, fs::path>> files_;  // temporary, final
};

// What stands beside the other files after some runs only: left from an earlier one, it would be compiled with this one's.
constexpr const char* not_of_every_run[] = {"tasks.hpp", "tasks.cpp", "batch.hpp", "batch.cpp", "batch_tasks.hpp"};

// Itself, and those within that the files are in.
std::set<fs::path> folders_of(const std::string& folder, const std::vector<OutputFile>& files) {
  std::set<fs::path> folders{folder};
  for (const OutputFile& file : files) folders.insert((fs::path(folder) / file.name).parent_path());
  return folders;
}

bool is_ours(const fs::path& path) {
  std::string start(4096, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(std::max<std::streamsize>(file.gcount(), 0)));
  return start.find(banner_mark) != start.npos;
}

}  // namespace

void check_folder(const std::string& folder) {
  std::error_code ignored;
  for (fs::path path = folder; !path.empty(); path = path.parent_path()) {
    if (fs::is_directory(path, ignored)) return;
    if (fs::exists(path, ignored))
      refuse(folder, path == folder ? "this is a file and no folder" : "'" + path.string() + "' is a file and no folder");
    if (path == path.parent_path()) return;
  }
}

void add_files(const std::string& folder, const std::vector<OutputFile>& files) {
  check_folder(folder);
  std::error_code error, ignored;
  for (const fs::path& each : folders_of(folder, files)) {
    check_folder(each.string());
    fs::create_directories(each, error);
    if (!fs::is_directory(each, ignored)) refuse(each, "the folder cannot be made" + (error ? ": " + error.message() : ""));
  }
  Staged staged;
  for (const OutputFile& file : files)
    if (const fs::path path = fs::path(folder) / file.name; !holds(path, file.text)) staged.add(path, file.text);
  staged.rename();
}

void write_files(const std::string& folder, const std::vector<OutputFile>& files) {
  std::error_code error;
  for (const OutputFile& file : files) {
    const fs::path path = fs::path(folder) / file.name;
    if (fs::is_regular_file(path, error) && fs::file_size(path, error) > 0 && !is_ours(path))
      throw InputError({Severity::error, path.string(), "", "a file that dalembert did not write stands here",
                        "move it, or name another folder with -o"});
  }
  add_files(folder, files);
  for (const fs::path& each : folders_of(folder, files))
    for (const char* name : not_of_every_run) {
      const fs::path path = each / name;
      const bool produced =
          std::any_of(files.begin(), files.end(), [&](const OutputFile& file) { return fs::path(folder) / file.name == path; });
      if (!produced && fs::is_regular_file(path, error) && is_ours(path)) fs::remove(path, error);
    }
}

}  // namespace dalembert::backend
