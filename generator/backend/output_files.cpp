#include "backend/output_files.hpp"

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
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

// Signals that end a program wait while it is there: what is written would stay under names of its own.
class Undisturbed {
 public:
  Undisturbed() {
    sigset_t ending;
    sigemptyset(&ending);
    for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGTERM}) sigaddset(&ending, signal);
    pthread_sigmask(SIG_BLOCK, &ending, &before_);
  }
  ~Undisturbed() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }

 private:
  sigset_t before_;
};

constexpr const char* temporary_ending = ".new";  // and the process's number

// What programs have left that were killed all the same.
void remove_left_over(const fs::path& path) {
  std::error_code ignored;
  const std::string start = path.filename().string() + temporary_ending;
  std::vector<fs::path> left;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  for (fs::directory_iterator entry(folder, ignored), end; !ignored && entry != end; entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    if (!name.starts_with(start) || name.size() == start.size()) continue;
    const std::string digits = name.substr(start.size());
    if (digits.find_first_not_of("0123456789") != digits.npos || digits.size() > 9) continue;
    if (kill(std::stoi(digits), 0) != 0 && errno == ESRCH) left.push_back(entry->path());
  }
  for (const fs::path& file : left) fs::remove(file, ignored);
}

// What is written: of a link, what it leads to.
fs::path target(const fs::path& named) {
  std::error_code error;
  fs::path path = named;
  if (fs::is_symlink(named, error)) {
    path = fs::canonical(named, error);
    if (error) refuse(named, "the link leads nowhere");
  }
  if (fs::is_directory(path, error)) refuse(path, "a folder stands in the file's place");
  return path;
}

void write_through(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  if (!(file << text << std::flush)) refuse(path, "it cannot be written");
}

// Files under their temporary names, until all of them are renamed; those that are not, are removed.
class Staged {
 public:
  ~Staged() {
    std::error_code ignored;
    for (const auto& [temporary, path] : files_) fs::remove(temporary, ignored);
  }

  // A file that was there keeps its permissions.
  void add(const fs::path& path, const std::string& text) {
    std::error_code error;
    const fs::file_status before = fs::status(path, error);
    if (fs::exists(before) && access(path.c_str(), W_OK) != 0) refuse(path, "the file cannot be written");
    fs::path temporary = path;
    temporary += temporary_ending + std::to_string(getpid());
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

bool is_no_file(const std::string& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) && !fs::is_regular_file(path, ignored);
}

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
  std::vector<fs::path> paths;
  for (const OutputFile& file : files) paths.push_back(target(fs::path(folder) / file.name));
  for (size_t i = 0; i < files.size(); ++i)  // may wait for a reader, and is not undone
    if (is_no_file(paths[i])) write_through(paths[i], files[i].text);
  const Undisturbed undisturbed;
  Staged staged;
  for (size_t i = 0; i < files.size(); ++i) {
    if (is_no_file(paths[i])) continue;
    remove_left_over(paths[i]);
    if (!holds(paths[i], files[i].text)) staged.add(paths[i], files[i].text);
  }
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
