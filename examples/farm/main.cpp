// A farm: MPI ranks compute a sweep of states, or the motions of an identification, block by block, into one HDF5 file.
//
// Each block is written when it is computed, and noted; whoever is killed, the same command goes on where it was. The file is
// the same, bit for bit, whatever the number of ranks, the blocks' size, and how often it was begun. README.md here is the
// page.
#include <mpi.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "draw.hpp"
#include "error.hpp"
#include "hand_out.hpp"
#include "job.hpp"
#include "options.hpp"
#include "store.hpp"

namespace {

using farm::Error;

constexpr int failure = 2;

void say(const Error& error) { std::fprintf(stderr, "farm: %s\n", error.what()); }

// What rank 0 does before the others may begin: of an error all are told, and all end.
template <class Prepare>
bool prepared(int rank, const Prepare& prepare) {
  int good = 1;
  if (rank == 0) {
    try {
      prepare();
    } catch (const Error& error) {
      say(error);
      good = 0;
    }
  }
  MPI_Bcast(&good, 1, MPI_INT, 0, MPI_COMM_WORLD);
  return good != 0;
}

void share(std::vector<double>& numbers) {
  std::uint64_t count = numbers.size();
  MPI_Bcast(&count, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  numbers.resize(count);
  constexpr std::uint64_t most = 1 << 24;  // MPI counts in int
  for (std::uint64_t at = 0; at < count; at += most)
    MPI_Bcast(numbers.data() + at, static_cast<int>(std::min(most, count - at)), MPI_DOUBLE, 0, MPI_COMM_WORLD);
}

// Room for a block's columns.
class Room {
 public:
  Room(const std::vector<farm::Column>& columns, std::size_t items) {
    for (const farm::Column& column : columns) {
      bytes_.push_back(column.bytes());
      memory_.emplace_back((bytes_.back() * items + 63) / 64);
    }
  }
  // The columns from item `first` of the block on.
  std::vector<void*> from(std::size_t first) {
    std::vector<void*> at;
    for (std::size_t c = 0; c < memory_.size(); ++c)
      at.push_back(reinterpret_cast<unsigned char*>(memory_[c].data()) + bytes_[c] * first);
    return at;
  }

 private:
  struct alignas(64) Line {
    unsigned char bytes[64];
  };
  std::vector<std::size_t> bytes_;
  std::vector<std::vector<Line>> memory_;
};

// Of the bits of the first results: code compiled otherwise, or a library that rounds otherwise, shows.
std::uint64_t fingerprint(farm::Job& job) {
  const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(job.items(), 64));
  const std::vector<farm::Column> columns = job.columns();
  Room room(columns, count);
  const std::vector<void*> at = room.from(0);
  job.compute(0, count, at);
  std::uint64_t all = 0;
  for (std::size_t c = 0; c < columns.size(); ++c)
    for (std::size_t i = 0; i < columns[c].bytes() * count; i += 4) {
      std::uint32_t bits;
      std::memcpy(&bits, static_cast<unsigned char*>(at[c]) + i, sizeof bits);
      all = farm::mixed(all ^ bits) + 1;
    }
  return all;
}

// Whether all ranks compute the same bits: results must not depend on who computes them.
bool all_agree(std::uint64_t mine, int rank, int ranks) {
  struct Rank {
    std::uint64_t print;
    char host[56];
  } own{mine, {}};
  gethostname(own.host, sizeof own.host - 1);
  std::vector<Rank> all(static_cast<std::size_t>(rank == 0 ? ranks : 0));
  MPI_Gather(&own, sizeof own, MPI_BYTE, all.data(), sizeof own, MPI_BYTE, 0, MPI_COMM_WORLD);
  return prepared(rank, [&] {
    for (const Rank& other : all)
      if (other.print != mine)
        throw Error("rank " + std::to_string(&other - all.data()) + " on " + other.host +
                    " computes other bits than rank 0 on " + own.host +
                    ": start the same program on all machines, compiled for the least of their processors");
  });
}

int run(int count, char** words, int rank, int ranks) {
  using Clock = std::chrono::steady_clock;
  farm::Options options;
  std::unique_ptr<farm::Job> job;
  farm::Recording recording;
  // Every rank reads the words, and only rank 0 says what is wrong with them.
  if (!prepared(rank, [&] { options = farm::read_options(count, words); })) return failure;
  if (rank != 0) options = farm::read_options(count, words);
  if (options.help) {
    if (rank == 0) std::fputs(farm::usage(), stdout);
    return 0;
  }
  if (options.command == "record") {
    return prepared(rank, [&] { farm::write_recording(options.out, farm::simulate_recording(options.steps, 5e-3)); }) ? 0
                                                                                                                      : failure;
  }
  if (options.command == "identify") {
    if (!prepared(rank, [&] { recording = farm::read_recording(options.recording); })) return failure;
    MPI_Bcast(&recording.time_step, 1, MPI_DOUBLE, 0, MPI_COMM_WORLD);
    std::uint64_t steps = recording.steps;
    MPI_Bcast(&steps, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
    recording.steps = steps;
    for (std::vector<double>* numbers : {&recording.q, &recording.v, &recording.tau}) share(*numbers);
    job = farm::make_identification(options.items, options.seed, std::move(recording));
  } else {
    job = farm::make_sweep(options.items, options.seed, options.results_only);
  }

  const std::uint64_t print = fingerprint(*job);
  if (!all_agree(print, rank, ranks)) return failure;
  const farm::Place place(options.out);
  const std::uint64_t items = job->items(), blocks = (items + options.block - 1) / options.block;
  std::unique_ptr<farm::Keeper> keeper;
  farm::Start start;
  if (!prepared(rank, [&] {
        keeper = std::make_unique<farm::Keeper>(place, *job, options.block, print);
        start = keeper->start();
      }))
    return failure;
  const std::vector<farm::Column> columns = job->columns();
  int complete = start.complete;
  MPI_Bcast(&complete, 1, MPI_INT, 0, MPI_COMM_WORLD);
  if (complete) {
    if (rank == 0) std::printf("%s is complete already\n", options.out.c_str());
    return 0;
  }
  start.offsets.resize(columns.size());
  MPI_Bcast(start.offsets.data(), static_cast<int>(columns.size()), MPI_UINT64_T, 0, MPI_COMM_WORLD);
  MPI_Bcast(&start.run, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);

  double computing = 0, writing = 0;
  const auto began = Clock::now();
  std::uint64_t mine = 0;
  try {
    const farm::Writer writer(place, start, rank, columns);
    Room room(columns, static_cast<std::size_t>(std::min(items, options.block)));
    auto said = began;
    mine = farm::hand_out(start.left, [&](std::uint64_t block, const std::function<void()>& pause) {
      // Nobody can go on without this rank's blocks, so that an error ends all of them.
      try {
        const auto t0 = Clock::now();
        const std::uint64_t first = block * options.block;
        const auto size = static_cast<std::size_t>(std::min(options.block, items - first));
        writer.begun(block);
        for (std::size_t at = 0; at < size; at += job->piece()) {
          job->compute(first + at, std::min(job->piece(), size - at), room.from(at));
          pause();
        }
        const auto t1 = Clock::now();
        writer.done(block, first, size, room.from(0));
        const auto t2 = Clock::now();
        computing += std::chrono::duration<double>(t1 - t0).count(), writing += std::chrono::duration<double>(t2 - t1).count();
        if (rank == 0 && t2 - said > std::chrono::seconds(10)) {
          said = t2;
          std::fprintf(stderr, "farm: block %llu of %llu\n", static_cast<unsigned long long>(block + 1),
                       static_cast<unsigned long long>(blocks));
        }
      } catch (const Error& error) {
        say(Error("rank " + std::to_string(rank) + ": " + error.what() + "; what is done is kept in " + place.folder()));
        MPI_Abort(MPI_COMM_WORLD, failure);
      }
    });
  } catch (const Error& error) {
    say(Error("rank " + std::to_string(rank) + ": " + error.what()));
    MPI_Abort(MPI_COMM_WORLD, failure);
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  double own[] = {computing, writing, static_cast<double>(mine)}, all[3] = {};
  MPI_Reduce(own, all, 3, MPI_DOUBLE, MPI_SUM, 0, MPI_COMM_WORLD);
  if (!prepared(rank, [&] { keeper->finish(); })) return failure;
  if (rank == 0) {
    std::size_t bytes = 0;
    for (const farm::Column& column : columns) bytes += column.bytes();
    const double done = all[2] > 0 ? all[2] : 1;
    std::printf(
        "%s: %llu items, %zu bytes each, in %llu blocks, %llu of them now, on %d ranks in %.2f s\n"
        "a block: %.1f ms computing, %.1f ms writing\n",
        options.out.c_str(), static_cast<unsigned long long>(items), bytes, static_cast<unsigned long long>(blocks),
        static_cast<unsigned long long>(start.left.size()), ranks, seconds, all[0] / done * 1e3, all[1] / done * 1e3);
  }
  return 0;
}

}  // namespace

int main(int count, char** words) {
  std::signal(SIGXFSZ, SIG_IGN);  // a write that is too much is an error like others
  MPI_Init(&count, &words);
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  const int status = run(count, words, rank, ranks);
  MPI_Finalize();
  return status;
}
