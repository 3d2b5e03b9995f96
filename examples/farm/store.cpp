#include "store.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <thread>

#include "hdf5.hpp"

namespace farm {

Error system_error(const std::string& file, const std::string& what, int number) {
  std::string advice;
  if (number == ENOSPC || number == EDQUOT) advice = "; make room there, or name another place with --out, and start again";
  if (number == EFBIG) advice = "; 'ulimit -f' says how large a file may be";
  return Error(file + ": " + what + ": " + std::strerror(number) + advice);
}

// ---- Files

File::File(const std::string& path, int flags) : path_(path), descriptor_(open(path.c_str(), flags | O_CLOEXEC, 0666)) {
  if (descriptor_ < 0) throw system_error(path, flags & O_CREAT ? "cannot be made" : "cannot be opened", errno);
}

File::~File() { close(descriptor_); }

void File::write_at(const void* bytes, std::size_t count, std::uint64_t offset) const {
  const char* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = pwrite(descriptor_, at, count, static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) throw system_error(path_, "cannot be written", written < 0 ? errno : EIO);
    at += written, count -= static_cast<std::size_t>(written), offset += static_cast<std::uint64_t>(written);
  }
}

void File::append(const std::string& text) const {
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t now = write(descriptor_, text.data() + written, text.size() - written);
    if (now < 0 && errno == EINTR) continue;
    if (now <= 0) throw system_error(path_, "cannot be written", now < 0 ? errno : EIO);
    written += static_cast<std::size_t>(now);
  }
}

void File::sync() const {
  if (fdatasync(descriptor_) != 0 && errno != EINVAL && errno != EROFS) throw system_error(path_, "cannot be written", errno);
}

namespace {

bool exists(const std::string& path) { return access(path.c_str(), F_OK) == 0; }

void sync_folder_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const File folder(slash == std::string::npos ? "." : path.substr(0, slash + 1), O_RDONLY | O_DIRECTORY);
  folder.sync();
}

void move(const std::string& from, const std::string& to) {
  if (rename(from.c_str(), to.c_str()) != 0) throw system_error(to, "cannot be made", errno);
  sync_folder_of(to);
}

std::string read_text(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

std::vector<std::string> names_in(const std::string& folder) {
  std::vector<std::string> names;
  if (DIR* const open = opendir(folder.c_str())) {
    while (const dirent* entry = readdir(open))
      if (entry->d_name[0] != '.') names.emplace_back(entry->d_name);
    closedir(open);
  }
  return names;
}

// The folder and what a farm puts into it, the lock last.
void remove_folder(const Place& place) {
  for (const std::string& name : names_in(place.folder()))
    if (name != "lock") unlink((place.folder() + "/" + name).c_str());
  unlink(place.lock().c_str());
  rmdir(place.folder().c_str());
}

// Where the texts differ first, as a reader wants to be told.
std::string difference(const std::string& there, const std::string& wanted) {
  std::istringstream a(there), b(wanted);
  for (std::string x, y;;) {
    const bool more_a = static_cast<bool>(std::getline(a, x)), more_b = static_cast<bool>(std::getline(b, y));
    if (!more_a && !more_b) return "";
    if (!more_a) x = "nothing";
    if (!more_b) y = "nothing";
    if (x != y) return "it says '" + x + "', and this run '" + y + "'";
  }
}

// ---- The HDF5 file

constexpr hsize_t page = 4096;
constexpr const char* settings_attribute = "settings";

void write_attribute(hid_t object, const char* name, const std::string& text) {
  const std::string failed = std::string("attribute '") + name + "' cannot be written";
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose, failed);
  H5Tset_size(type, std::max<std::size_t>(1, text.size()));
  H5Tset_cset(type, H5T_CSET_UTF8);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose, failed);
  const Handle attribute(H5Acreate2(object, name, type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, failed);
  const char* const bytes = text.empty() ? "\0" : text.data();
  if (H5Awrite(attribute, type, bytes) < 0) throw Error(failed);
}

std::string read_settings(const std::string& path) {
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose,
                    path + ": is there, and no HDF5 file; name another file with --out");
  const std::string failed = path + ": is there, and not of this program; name another file with --out";
  const Handle attribute(H5Aopen(file, settings_attribute, H5P_DEFAULT), H5Aclose, failed);
  const Handle type(H5Aget_type(attribute), H5Tclose, failed);
  if (H5Tget_class(type) != H5T_STRING || H5Tis_variable_str(type) > 0) throw Error(failed);
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(attribute, type, text.data()) < 0) throw Error(failed);
  return text;
}

// Nothing in it depends on who makes it, when, or how many work on it. Datasets begin at pages.
void make_file(const std::string& path, const std::vector<Column>& columns, std::uint64_t items, const std::string& settings) {
  const std::string failed = path + ": cannot be made; is the disk full?";
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, failed);
  H5Pset_alignment(access, page, page);
  Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access), H5Fclose, failed);
  write_attribute(file, settings_attribute, settings);
  for (const Column& column : columns) {
    const hsize_t size[] = {items, column.width};
    const Handle space(H5Screate_simple(column.width > 1 ? 2 : 1, size, nullptr), H5Sclose, failed);
    const Handle how(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, failed);
    H5Pset_layout(how, H5D_CONTIGUOUS);
    H5Pset_alloc_time(how, H5D_ALLOC_TIME_EARLY);
    H5Pset_fill_time(how, H5D_FILL_TIME_NEVER);
    H5Pset_obj_track_times(how, false);
    const Handle set(H5Dcreate2(file, column.name.c_str(), column.integer ? H5T_STD_I32LE : H5T_IEEE_F64LE, space, H5P_DEFAULT,
                                how, H5P_DEFAULT),
                     H5Dclose, failed);
    write_attribute(set, "unit", column.unit);
    write_attribute(set, "meaning", column.meaning);
  }
  if (!file.close()) throw Error(failed);
}

std::vector<std::uint64_t> offsets_in(const std::string& path, const std::vector<Column>& columns) {
  const std::string failed = path + ": is damaged; remove the folder that it is in, and start again";
  const Handle file(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT), H5Fclose, failed);
  std::vector<std::uint64_t> offsets;
  for (const Column& column : columns) {
    const Handle set(H5Dopen2(file, column.name.c_str(), H5P_DEFAULT), H5Dclose, failed);
    offsets.push_back(H5Dget_offset(set));
    if (offsets.back() == HADDR_UNDEF) throw Error(failed);
  }
  return offsets;
}

std::string size_text(std::uint64_t bytes) {
  char text[64];
  const double b = static_cast<double>(bytes);
  std::snprintf(text, sizeof text,
                b < 1e6   ? "%.0f bytes"
                : b < 1e9 ? "%.1f MB"
                          : "%.2f GB",
                b < 1e6   ? b
                : b < 1e9 ? b / 1e6
                          : b / 1e9);
  return text;
}

// So that a disk is full now, or never.
void reserve(const std::string& path, std::uint64_t bytes) {
  const File file(path, O_RDWR | O_CREAT);
  if (const int error = posix_fallocate(file.descriptor(), 0, static_cast<off_t>(bytes)))
    throw system_error(path, size_text(bytes) + " cannot be reserved", error);
}

}  // namespace

// ---- Rank 0

// Whether what is open still stands there under its name.
static bool is_still(const File& file, const std::string& name) {
  struct stat open {
  }, there{};
  return fstat(file.descriptor(), &open) == 0 && stat(name.c_str(), &there) == 0 && open.st_dev == there.st_dev &&
         open.st_ino == there.st_ino;
}

Keeper::Keeper(Place place, const Job& job, std::uint64_t block, std::uint64_t fingerprint) : place_(std::move(place)) {
  no_hdf5_messages();
  const std::uint64_t items = job.items(), blocks = (items + block - 1) / block;
  const std::string results = job.settings() + "results " + std::to_string(fingerprint) + "\n";
  settings_ = results;
  const std::string plan = results + "block " + std::to_string(block) + "\n";
  const std::vector<Column> columns = job.columns();
  std::uint64_t bytes = 0;
  for (const Column& column : columns) bytes += column.bytes();
  if (items > (std::uint64_t{1} << 62) / bytes)
    throw Error(std::to_string(items) + " items of " + std::to_string(bytes) + " bytes are more than a file can hold");
  bytes *= items;
  rlimit most{};
  if (getrlimit(RLIMIT_FSIZE, &most) == 0 && most.rlim_cur != RLIM_INFINITY && bytes > most.rlim_cur)
    throw Error(place_.out() + ": " + size_text(bytes) + " are more than a file may have here ('ulimit -f': " +
                size_text(most.rlim_cur) + "); compute fewer items, or raise the limit");
  do {  // again where the run that was waited for has ended, and taken its folder away
    if (exists(place_.out())) {
      const std::string differs = difference(read_settings(place_.out()), results);
      if (!differs.empty())
        throw Error(place_.out() + ": is there, of another run: " + differs + "; name another file with --out, or remove it");
      remove_folder(place_);  // killed between the last two steps
      start_.complete = true;
      return;
    }
    const bool is_new = mkdir(place_.folder().c_str(), 0777) == 0;
    if (!is_new && errno != EEXIST) throw system_error(place_.folder(), "the folder cannot be made", errno);
    lock_ = std::make_unique<File>(place_.lock(), O_RDWR | O_CREAT);
    // Whoever was killed a moment ago may hold it a moment longer.
    bool mine = false;
    for (int patience = 0; !(mine = flock(lock_->descriptor(), LOCK_EX | LOCK_NB) == 0) && patience < 30; ++patience)
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    if (!mine) throw Error(place_.folder() + ": another run is at work there; wait for it, or name another file with --out");
  } while (!is_still(*lock_, place_.lock()));
  if (exists(place_.data())) {
    const std::string differs = difference(read_text(place_.settings()), plan);
    if (!differs.empty())
      throw Error(place_.folder() + ": was begun by another run: " + differs + "; give the same again, or remove the folder");
    find_done(blocks);
  } else {  // a new one, or one that was killed before anything was computed
    try {
      for (const std::string& name : names_in(place_.folder()))
        if (name != "lock") unlink((place_.folder() + "/" + name).c_str());
      {
        const File settings(place_.settings(), O_WRONLY | O_CREAT | O_TRUNC);
        settings.append(plan);
        settings.sync();
      }
      begin(columns, items);
    } catch (...) {
      remove_folder(place_);
      throw;
    }
    find_done(blocks);
  }
  start_.offsets = offsets_in(place_.data(), columns);
}

void Keeper::begin(const std::vector<Column>& columns, std::uint64_t items) {
  const std::string unfinished = place_.data() + ".new";
  std::uint64_t bytes = 0;
  for (const Column& column : columns) bytes += column.bytes() * items;
  reserve(unfinished, bytes);  // HDF5 would not say why there is no room
  make_file(unfinished, columns, items, settings_);
  struct stat is {};
  if (stat(unfinished.c_str(), &is) != 0) throw system_error(unfinished, "cannot be read", errno);
  reserve(unfinished, static_cast<std::uint64_t>(is.st_size));
  File(unfinished, O_RDWR).sync();
  move(unfinished, place_.data());
}

// Reads the journals: what is done need not be done again.
void Keeper::find_done(std::uint64_t blocks) {
  std::vector<bool> done(blocks, false);
  for (const std::string& name : names_in(place_.folder())) {
    unsigned long run = 0;
    int rank = 0;
    if (std::sscanf(name.c_str(), "journal.%lu.%d", &run, &rank) != 2) continue;
    start_.run = std::max<std::uint64_t>(start_.run, run + 1);
    const std::string text = read_text(place_.folder() + "/" + name);
    for (std::size_t at = 0, end; (end = text.find('\n', at)) != std::string::npos; at = end + 1) {
      unsigned long long block = 0;
      int read = 0;
      const std::string line = text.substr(at, end - at);
      if (std::sscanf(line.c_str(), "done %llu%n", &block, &read) == 1 && static_cast<std::size_t>(read) == line.size() &&
          block < blocks)
        done[block] = true;
    }
  }
  for (std::uint64_t block = 0; block < blocks; ++block)
    if (!done[block]) start_.left.push_back(block);
}

void Keeper::finish() {
  File(place_.data(), O_RDWR).sync();
  move(place_.data(), place_.out());
  remove_folder(place_);
}

// ---- Every rank

Writer::Writer(const Place& place, const Start& start, int rank, std::vector<Column> columns)
    : columns_(std::move(columns)),
      offsets_(start.offsets),
      data_(place.data(), O_WRONLY),
      journal_(place.journal(start.run, rank), O_WRONLY | O_CREAT | O_EXCL | O_APPEND) {}

void Writer::begun(std::uint64_t block) const { journal_.append("begun " + std::to_string(block) + "\n"); }

void Writer::done(std::uint64_t block, std::uint64_t first, std::size_t count, const std::vector<void*>& into) const {
  for (std::size_t c = 0; c < columns_.size(); ++c)
    data_.write_at(into[c], count * columns_[c].bytes(), offsets_[c] + first * columns_[c].bytes());
  data_.sync();
  journal_.append("done " + std::to_string(block) + "\n");
  journal_.sync();
}

}  // namespace farm
