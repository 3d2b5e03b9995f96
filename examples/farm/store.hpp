// Results in one HDF5 file that many processes write and any may be killed at any moment.
//
// The file is made whole at first, its room reserved on the disk: each column a dataset of one piece (contiguous, allocated
// early, nothing filled in), so that a block of items has its place in the file from the beginning, the same whoever writes it.
// Ranks write their blocks there with pwrite(); HDF5 has told where (H5Dget_offset). No rank touches what describes the
// datasets, so that a kill cannot damage it; blocks are whole pages, so that no two ranks write to one page.
//
//   OUT.work/settings          what is computed, and in blocks of how many items
//   OUT.work/data.h5           the file; it becomes OUT when every block is there
//   OUT.work/journal.RUN.RANK  lines `begun BLOCK` and `done BLOCK`: the checkpoint. `done` stands there when the block's
//   numbers
//                              are on the disk. A last line without its end was cut off, and does not count.
//   OUT.work/lock              held by rank 0 while a run is at work
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "job.hpp"

namespace farm {

// What rank 0 found or made, and the others are told.
struct Start {
  std::uint64_t run = 0;               // this one, of those that have worked in the folder
  bool complete = false;               // OUT is there already, with these settings
  std::vector<std::uint64_t> offsets;  // of each column's dataset, in the file
  std::vector<std::uint64_t> left;     // blocks that nobody has done; rank 0's alone
};

class Place {
 public:
  explicit Place(std::string out) : out_(std::move(out)) {}
  const std::string& out() const { return out_; }
  std::string folder() const { return out_ + ".work"; }
  std::string data() const { return folder() + "/data.h5"; }
  std::string settings() const { return folder() + "/settings"; }
  std::string lock() const { return folder() + "/lock"; }
  std::string journal(std::uint64_t run, int rank) const {
    return folder() + "/journal." + std::to_string(run) + "." + std::to_string(rank);
  }

 private:
  std::string out_;
};

// A file descriptor.
class File {
 public:
  File(const std::string& path, int flags);  // throws Error
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  ~File();
  void write_at(const void* bytes, std::size_t count, std::uint64_t offset) const;  // all of them, or Error
  void append(const std::string& text) const;
  void sync() const;  // what was written is on the disk
  int descriptor() const { return descriptor_; }

 private:
  std::string path_;
  int descriptor_;
};

// Rank 0's part: makes the folder and the file, or finds what an earlier run has left. Nothing is left behind where it throws
// and the folder was not there before. `fingerprint` is of what the code computes here.
class Keeper {
 public:
  Keeper(Place place, const Job& job, std::uint64_t block, std::uint64_t fingerprint);
  const Start& start() const { return start_; }
  // Every block is there: OUT appears, the folder goes.
  void finish();

 private:
  void begin(const std::vector<Column>& columns, std::uint64_t items);
  void find_done(std::uint64_t blocks);

  Place place_;
  std::string settings_;
  Start start_;
  std::unique_ptr<File> lock_;
};

// Every rank's part.
class Writer {
 public:
  Writer(const Place& place, const Start& start, int rank, std::vector<Column> columns);
  void begun(std::uint64_t block) const;
  // Writes `count` items from number `first` on, into[c] being those of column c, and then that the block is done.
  void done(std::uint64_t block, std::uint64_t first, std::size_t count, const std::vector<void*>& into) const;

 private:
  std::vector<Column> columns_;
  std::vector<std::uint64_t> offsets_;
  File data_, journal_;
};

}  // namespace farm
