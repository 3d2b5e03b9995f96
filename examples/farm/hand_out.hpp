// Blocks of work, handed to ranks as they come free.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

namespace farm {

// Calls work(block, pause) on this rank for some of the blocks, so that together the ranks get each of `left` (rank 0's; of
// others it is not read) once, in that order, and returns when all ranks have done all. While a rank works on a block it has
// already asked for its next, so that it need not wait. Rank 0 works as well: between pieces of a block it calls pause(), which
// serves the others. MPI is initialised; work throws nothing. Returns how many blocks this rank worked on.
using Work = std::function<void(std::uint64_t block, const std::function<void()>& pause)>;
std::uint64_t hand_out(const std::vector<std::uint64_t>& left, const Work& work);

}  // namespace farm
