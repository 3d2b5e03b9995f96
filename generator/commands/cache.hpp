// The folder of compiled code that is used again: one entry per robot, scene, compiler and processor.
//
// An entry is a folder named by the hash of all that went into it. It is made under another name and renamed when it is whole,
// so that whoever dies while making it leaves nothing that is taken for an entry. Who makes one holds a lock; others who want
// the same wait for it, and find it made.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace dalembert {

// $XDG_CACHE_HOME/dalembert, or ~/.cache/dalembert. Throws InputError where neither variable is set to an absolute path.
std::filesystem::path cache_folder();

// Hashes, 128 bits as 32 digits: tells inputs from one another; no protection against anyone.
class Hash {
 public:
  // A part of the whole, by name: parts do not run into one another.
  void add(std::string_view name, std::string_view content);
  std::string digits() const;

 private:
  void add_bytes(std::string_view bytes);
  std::uint64_t a_ = 0xcbf29ce484222325ull, b_ = 0x9e3779b97f4a7c15ull;
};

// The entry of that key. Where there is none yet, `make` is called with an empty folder to fill, once among all processes that
// ask at the same time. Throws what `make` throws, and InputError where the cache cannot be written.
std::filesystem::path cached(const std::string& key, const std::function<void(const std::filesystem::path& folder)>& make);

// Adds to an entry what it lacks of these files: `make` is called with the numbers of those that are not there and an empty
// folder, and returns what it made as (path, name in the entry), in the order to appear in. Once among all processes, as
// cached().
using Made = std::vector<std::pair<std::filesystem::path, std::string>>;
void add_to_entry(const std::filesystem::path& entry, const std::vector<std::string>& names,
                  const std::function<Made(const std::vector<size_t>& missing, const std::filesystem::path& folder)>& make);

// The file by which an entry is known to be whole: written last.
inline constexpr const char* entry_file = "robot.json";

struct CacheEntry {
  std::filesystem::path folder;
  std::uintmax_t bytes = 0;
  std::filesystem::file_time_type time;
};

// The entries, the latest first.
std::vector<CacheEntry> cache_entries();

// Removes the entries, and what was left by those who died making one. Entries in the making stay. How many entries there were.
int clear_cache();

}  // namespace dalembert
