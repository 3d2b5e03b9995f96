#include "commands/cache.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <system_error>

#include "diagnostics.hpp"

namespace dalembert {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view lock_suffix = ".lock", making_infix = ".making.";

[[noreturn]] void refuse(const fs::path& place, const std::string& why) {
  throw InputError(
      {Severity::error, place.string(), "cache", why, "make room, or set XDG_CACHE_HOME to a folder that can be written"});
}

// Held by this process until it ends, however it ends.
class Lock {
 public:
  // Waits for whoever holds it, unless told not to: held() says.
  Lock(fs::path path, bool wait) : path_(std::move(path)) {
    for (;;) {
      file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
      if (file_ < 0) refuse(path_, std::strerror(errno));
      int failed;
      do failed = flock(file_, LOCK_EX | (wait ? 0 : LOCK_NB));
      while (failed && errno == EINTR);
      const bool busy = failed && errno == EWOULDBLOCK;
      if (failed && !busy) {
        const int error = errno;
        close(file_);
        refuse(path_, fmt::format("it cannot be locked: {}", std::strerror(error)));
      }
      // Whoever held it before may have removed the file: then another's lock is on a new one.
      struct stat mine, there;
      if (!busy && fstat(file_, &mine) == 0 && stat(path_.c_str(), &there) == 0 && mine.st_ino == there.st_ino) return;
      close(file_);
      file_ = -1;
      if (busy) return;
    }
  }
  ~Lock() {
    if (file_ < 0) return;
    unlink(path_.c_str());
    close(file_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  bool held() const { return file_ >= 0; }

 private:
  fs::path path_;
  int file_ = -1;
};

bool is_whole(const fs::path& entry) {
  std::error_code error;
  return fs::exists(entry / entry_file, error);
}

// What is being made, or was by one who died, begins with the key.
std::vector<fs::path> in_the_making(const fs::path& folder, const std::string& key) {
  std::vector<fs::path> found;
  std::error_code error;
  for (const fs::directory_entry& at : fs::directory_iterator(folder, error))
    if (at.path().filename().string().starts_with(key + std::string(making_infix))) found.push_back(at.path());
  return found;
}

void remove_tree(const fs::path& path) {
  std::error_code ignored;
  fs::remove_all(path, ignored);
}

std::string new_folder(const fs::path& folder, const std::string& key) {
  std::string making = (folder / (key + std::string(making_infix) + "XXXXXX")).string();
  if (!mkdtemp(making.data())) refuse(making, std::strerror(errno));
  return making;
}

// Onto the disk, so that a name never stands for a file that a power cut took.
void synchronise(const fs::path& folder) {
  std::error_code error;
  for (const fs::directory_entry& at : fs::directory_iterator(folder, error)) {
    if (!at.is_regular_file(error)) continue;
    const int file = open(at.path().c_str(), O_RDONLY | O_CLOEXEC);
    if (file < 0) continue;
    const int failed = fsync(file);
    close(file);
    if (failed) refuse(at.path(), std::strerror(errno));
  }
}

bool is_key(const std::string& name) {
  return name.size() == 32 && name.find_first_not_of("0123456789abcdef") == std::string::npos;
}

}  // namespace

fs::path cache_folder() {
  for (const auto& [variable, below] : {std::pair{"XDG_CACHE_HOME", "dalembert"}, {"HOME", ".cache/dalembert"}}) {
    const char* const value = std::getenv(variable);
    if (value && fs::path(value).is_absolute()) return fs::path(value) / below;
  }
  throw InputError({Severity::error, "", "cache", "neither XDG_CACHE_HOME nor HOME is the absolute path of a folder",
                    "set XDG_CACHE_HOME to a folder for compiled code"});
}

void Hash::add_bytes(std::string_view bytes) {
  for (const char c : bytes) {
    a_ = (a_ ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
    b_ = (b_ + static_cast<unsigned char>(c) + 1) * 0xbf58476d1ce4e5b9ull;
    b_ ^= b_ >> 29;
  }
}

void Hash::add(std::string_view name, std::string_view content) {
  add_bytes(fmt::format("{} {}:", name, content.size()));
  add_bytes(content);
}

std::string Hash::digits() const { return fmt::format("{:016x}{:016x}", a_, b_); }

fs::path cached(const std::string& key, const std::function<void(const fs::path& folder)>& make) {
  const fs::path folder = cache_folder(), entry = folder / key;
  if (is_whole(entry)) return entry;
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) refuse(folder, error.message());
  const Lock lock(folder / (key + std::string(lock_suffix)), true);
  if (is_whole(entry)) return entry;
  for (const fs::path& left : in_the_making(folder, key)) remove_tree(left);
  remove_tree(entry);  // of another's making
  const std::string making = new_folder(folder, key);
  try {
    make(making);
    if (!is_whole(making)) refuse(making, "an entry was not finished");
    synchronise(making);
    fs::rename(making, entry, error);
    if (error) refuse(entry, error.message());
  } catch (...) {
    remove_tree(making);
    throw;
  }
  return entry;
}

void add_to_entry(const fs::path& entry, const std::vector<std::string>& names,
                  const std::function<Made(const std::vector<size_t>& missing, const fs::path& folder)>& make) {
  const auto lacking = [&] {
    std::vector<size_t> missing;
    for (size_t i = 0; i < names.size(); ++i)
      if (!fs::exists(entry / names[i])) missing.push_back(i);
    return missing;
  };
  if (lacking().empty()) return;
  const fs::path folder = entry.parent_path();
  const std::string key = entry.filename().string();
  const Lock lock(folder / (key + std::string(lock_suffix)), true);
  const std::vector<size_t> missing = lacking();
  if (missing.empty()) return;
  if (!is_whole(entry)) refuse(entry, "there is no such entry");
  for (const fs::path& left : in_the_making(folder, key)) remove_tree(left);
  const std::string making = new_folder(folder, key);
  try {
    const Made made = make(missing, making);
    synchronise(making);
    std::error_code error;
    for (const auto& [path, name] : made) {
      fs::rename(path, entry / name, error);
      if (error) refuse(entry / name, error.message());
    }
  } catch (...) {
    remove_tree(making);
    throw;
  }
  remove_tree(making);
}

std::vector<CacheEntry> cache_entries() {
  std::vector<CacheEntry> entries;
  std::error_code error;
  for (const fs::directory_entry& at : fs::directory_iterator(cache_folder(), error)) {
    if (!is_key(at.path().filename().string()) || !is_whole(at.path())) continue;
    CacheEntry entry{at.path(), 0, fs::last_write_time(at.path() / entry_file, error)};
    for (const fs::directory_entry& file : fs::recursive_directory_iterator(at.path(), error))
      if (file.is_regular_file(error)) entry.bytes += file.file_size(error);
    entries.push_back(std::move(entry));
  }
  std::sort(entries.begin(), entries.end(), [](const CacheEntry& a, const CacheEntry& b) { return a.time > b.time; });
  return entries;
}

int clear_cache() {
  const fs::path folder = cache_folder();
  std::error_code error;
  std::vector<std::string> keys;
  for (const fs::directory_entry& at : fs::directory_iterator(folder, error)) {
    const std::string name = at.path().filename().string(), key = name.substr(0, 32);
    if (is_key(key) && std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  }
  int removed = 0;
  for (const std::string& key : keys) {
    const Lock lock(folder / (key + std::string(lock_suffix)), false);
    if (!lock.held()) continue;
    for (const fs::path& left : in_the_making(folder, key)) remove_tree(left);
    if (is_whole(folder / key)) ++removed;
    // First out of sight, whole: who loads it meanwhile finds it or does not.
    const fs::path going = folder / (key + std::string(making_infix) + "going");
    fs::rename(folder / key, going, error);
    remove_tree(going);
  }
  return removed;
}

}  // namespace dalembert
