#include "hand_out.hpp"

#include <mpi.h>

#include <chrono>
#include <cstddef>
#include <thread>

namespace farm {

namespace {

constexpr int ask = 1, answer = 2;  // tags
constexpr std::uint64_t none = ~std::uint64_t{0};

// MPI's own waiting keeps a core busy.
template <class Ready>
void wait_for(const Ready& ready) {
  while (!ready()) std::this_thread::sleep_for(std::chrono::microseconds(50));
}

class Server {
 public:
  Server(const std::vector<std::uint64_t>& left, int others) : left_(left), others_(others) {}

  std::uint64_t next() { return at_ < left_.size() ? left_[at_++] : none; }

  // Answers whoever has asked.
  void serve() {
    for (;;) {
      int asked = 0;
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, ask, MPI_COMM_WORLD, &asked, &status);
      if (!asked) return;
      MPI_Recv(nullptr, 0, MPI_BYTE, status.MPI_SOURCE, ask, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
      const std::uint64_t block = next();
      MPI_Send(&block, 1, MPI_UINT64_T, status.MPI_SOURCE, answer, MPI_COMM_WORLD);
      others_ -= block == none;
    }
  }

  bool all_know() const { return others_ == 0; }

 private:
  const std::vector<std::uint64_t>& left_;
  std::size_t at_ = 0;
  int others_;  // that have not been told that there is no more
};

}  // namespace

std::uint64_t hand_out(const std::vector<std::uint64_t>& left, const Work& work) {
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  std::uint64_t mine = 0;
  if (rank == 0) {
    Server server(left, ranks - 1);
    for (std::uint64_t block; (block = server.next()) != none; ++mine) {
      server.serve();
      work(block, [&] { server.serve(); });
    }
    wait_for([&] {
      server.serve();
      return server.all_know();
    });
  } else {
    std::uint64_t next = none;
    MPI_Request answered;
    const auto ask_for_next = [&] {
      MPI_Irecv(&next, 1, MPI_UINT64_T, 0, answer, MPI_COMM_WORLD, &answered);
      MPI_Send(nullptr, 0, MPI_BYTE, 0, ask, MPI_COMM_WORLD);
    };
    for (ask_for_next();; ++mine) {
      wait_for([&] {
        int ready = 0;
        MPI_Test(&answered, &ready, MPI_STATUS_IGNORE);
        return ready != 0;
      });
      const std::uint64_t block = next;
      if (block == none) break;
      ask_for_next();
      work(block, [] {});
    }
  }
  MPI_Request all;
  MPI_Ibarrier(MPI_COMM_WORLD, &all);
  wait_for([&] {
    int ready = 0;
    MPI_Test(&all, &ready, MPI_STATUS_IGNORE);
    return ready != 0;
  });
  return mine;
}

}  // namespace farm
