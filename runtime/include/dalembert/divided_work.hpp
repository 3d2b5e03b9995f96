// Work that threads divide among them, each after it has prepared for itself what the work reads: so nothing is handed from one
// core's caches to another's but what the call takes. Beside task_graph.hpp the only header that needs oneTBB.
//
// Each thread has a stretch of the work, much the same in every call, for what it writes is in its caches; it takes half of
// what is left of it at a time, from the front. Who has finished takes from the back of another's, and has a longer stretch the
// next time. Nobody waits for a thread that has not come: its stretch is taken too. As in task_graph.hpp, who calls takes no
// other task of oneTBB's while it waits.
#pragma once

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <atomic>
#include <cstdint>
#include <deque>
#include <functional>
#include <utility>
#include <vector>

#include "happens_before.hpp"
#include "pause.hpp"

namespace dalembert {

class DividedWork {
 public:
  // Of a place: 0 is the calling thread, others are threads that help.
  using Work = std::function<void(int place)>;
  // Of a part's columns [begin, end).
  using Columns = std::function<void(int place, int begin, int end)>;

  // `threads`: the most that are of use.
  explicit DividedWork(int threads) {
    for (int place = 0; place < threads; ++place) places_.emplace_back();
  }
  DividedWork(const DividedWork&) = delete;
  DividedWork& operator=(const DividedWork&) = delete;

  // What a thread does once in a call, before the first part that needs it; `units`: what it takes, the measure being free.
  // Returns its number.
  int prepare(Work work, int units) {
    preparations_.push_back(std::move(work));
    preparing_ += units;
    return static_cast<int>(preparations_.size()) - 1;
  }

  // A part: columns that take about the same each, `units` all of them. Columns are divided where their number is a multiple of
  // `step`; 0: not at all. `needs`: preparations, in their order.
  void add(Columns work, int columns, int step, int units, std::vector<int> needs) {
    parts_.push_back({std::move(work), columns, step, all_, units < 1 ? 1 : units, std::move(needs)});
    all_ += parts_.back().units;
  }

  // What the calling thread does when all parts are done; it needs all preparations.
  void end_with(Work work) { end_ = std::move(work); }

  // Does everything once.
  void run() {
    const int most = static_cast<int>(places_.size()), here = tbb::this_task_arena::max_concurrency();
    const int threads = here < most ? here : most;
    begin(0);
    if (threads < 2) compute({0, all_}, 0);
    else run_on(threads);
    if (!end_) return;
    for (int p = 0; p < static_cast<int>(preparations_.size()); ++p) have(p, 0);
    end_(0);
  }

 private:
  static constexpr int none = -1;
  // Fewer units than these are sooner done by the thread whose they are, which has them in its caches; but others do not wait
  // for ever: a pause is some 10 to 40 ns. Smaller pieces read again what they have in common.
  static constexpr int too_few = 15, even = 5, least_piece = 8, patience = 400, pauses_per_unit = 8;

  struct Part {
    Columns work;
    int columns, step, first_unit, units;
    std::vector<int> needs;

    // The first column of a unit.
    int column(int unit) const {
      if (unit >= units) return columns;
      if (step == 0) return unit <= 0 ? 0 : columns;
      return static_cast<int>(static_cast<long long>(columns) * (unit < 0 ? 0 : unit) / units) / step * step;
    }
  };
  struct Stretch {
    int begin, end;
    int size() const { return end - begin; }
  };
  struct Place {
    alignas(64) std::atomic<std::uint64_t> left{0};  // a Stretch
    std::atomic<bool> taken{false};
    std::atomic<int> thread{none};  // the last time
    std::vector<char> prepared;
    int units = 0;    // of its stretch
    int done = 0;     // in the last call
    int waited = 0;   // pauses
    double lead = 0;  // units that it could have done beside its stretch, over the last calls
  };

  static std::uint64_t word(Stretch s) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(s.begin)) << 32 | static_cast<std::uint32_t>(s.end);
  }
  static Stretch stretch(std::uint64_t w) { return {static_cast<int>(w >> 32), static_cast<int>(w & 0xffffffffu)}; }
  Place& place(int number) { return places_[static_cast<std::size_t>(number)]; }

  void run_on(int threads) {
    divide(threads);
    int from = 0;
    for (int p = 0; p < threads; ++p) {
      place(p).left.store(word({from, from + place(p).units}), std::memory_order_relaxed);
      from += place(p).units;
    }
    undone_.store(all_, std::memory_order_release);
    detail::happens_before(&helpers_);
    tbb::this_task_arena::isolate([this, threads] {
      for (int i = 1; i < threads; ++i)
        helpers_.run([this] {
          detail::happens_after(&helpers_);
          help();
          detail::happens_before(this);
        });
      take_part(0);
      helpers_.wait();
    });
    detail::happens_after(this);
  }

  // Equal stretches at first; then more, by and by, for who has done more in the last calls or has waited for others. By and
  // by: what changes hands has to be fetched from another's caches.
  void divide(int threads) {
    if (threads != threads_) {
      threads_ = threads;
      for (int p = 0; p < threads; ++p) {
        Place& of = place(p);
        of.units = of.done = share(p + 1) - share(p);
        of.waited = 0, of.lead = 0;
      }
      return;
    }
    int waited = 0, given = 0;
    for (int p = 0; p < threads; ++p) waited += place(p).waited / threads;
    for (int p = 0; p < threads; ++p) {
      Place& of = place(p);
      const int ahead = of.done - of.units + (of.waited - waited) / (2 * pauses_per_unit);
      of.lead += (ahead - of.lead) / 8;
      const int more = of.lead > even ? 1 : of.lead < -even && of.units > 0 ? -1 : 0;
      of.units += more;
      given += more;
    }
    for (int p = 0; given != 0; p = (p + 1) % threads) {  // so that it adds up
      if (given < 0) ++place(p).units, ++given;
      else if (place(p).units > 0) --place(p).units, --given;
    }
    for (int p = 0; p < threads; ++p) place(p).done = place(p).units, place(p).waited = 0;
  }
  int share(int p) const { return static_cast<int>(static_cast<long long>(all_) * p / threads_); }

  void help() {
    int left = 0;
    for (int p = 0; p < threads_; ++p) left += stretch(place(p).left.load(std::memory_order_acquire)).size();
    if (left <= preparing_) return;
    const int mine = take_place(tbb::this_task_arena::current_thread_index());
    if (mine == none) return;
    begin(mine);
    take_part(mine);
    place(mine).taken.store(false, std::memory_order_release);
  }

  // That which the thread had the last time, else any that nobody has.
  int take_place(int thread) {
    for (const bool own : {true, false})
      for (int p = 1; p < threads_; ++p) {
        if (own && place(p).thread.load(std::memory_order_relaxed) != thread) continue;
        if (place(p).taken.exchange(true, std::memory_order_acq_rel)) continue;
        place(p).thread.store(thread, std::memory_order_relaxed);
        return p;
      }
    return none;
  }

  void begin(int mine) { place(mine).prepared.assign(preparations_.size(), 0); }

  void have(int preparation, int mine) {
    char& is = place(mine).prepared[static_cast<std::size_t>(preparation)];
    if (!is) preparations_[static_cast<std::size_t>(preparation)](mine);
    is = 1;
  }

  void take_part(int mine) {
    int waited = 0, done = 0;
    for (int now = 0; undone_.load(std::memory_order_acquire) > 0;) {
      Stretch got = from_front(mine);
      if (got.size() == 0) got = from_others(mine, now >= patience);
      if (got.size() == 0) {
        detail::pause();
        ++now, ++waited;
        continue;
      }
      now = 0;
      compute(got, mine);
      done += got.size();
      undone_.fetch_sub(got.size(), std::memory_order_acq_rel);
    }
    place(mine).done = done;
    place(mine).waited = waited;
  }

  Stretch from_front(int p) {
    std::uint64_t before = place(p).left.load(std::memory_order_acquire);
    while (true) {
      const Stretch s = stretch(before);
      if (s.size() <= 0) return {0, 0};
      const int half = (s.size() + 1) / 2, least = s.size() < least_piece ? s.size() : least_piece;
      const int some = half > least ? half : least;
      if (place(p).left.compare_exchange_weak(before, word({s.begin + some, s.end}), std::memory_order_acq_rel))
        return {s.begin, s.begin + some};
    }
  }

  // Half of what is left of the longest of the others' stretches; of a thread that has not come, however little it is.
  Stretch from_others(int mine, bool impatient) {
    int longest = none, most = 0;
    for (int p = 0; p < threads_; ++p) {
      if (p == mine) continue;
      const int size = stretch(place(p).left.load(std::memory_order_acquire)).size();
      const bool here = p == 0 || place(p).taken.load(std::memory_order_acquire);
      if (size > most && (size > too_few || impatient || !here)) longest = p, most = size;
    }
    if (longest == none) return {0, 0};
    std::uint64_t before = place(longest).left.load(std::memory_order_acquire);
    const Stretch s = stretch(before);
    if (s.size() <= 0) return {0, 0};
    const int some = (s.size() + 1) / 2;
    if (!place(longest).left.compare_exchange_strong(before, word({s.begin, s.end - some}), std::memory_order_acq_rel))
      return {0, 0};
    return {s.end - some, s.end};
  }

  void compute(Stretch units, int mine) {
    for (const Part& part : parts_) {
      if (units.begin >= part.first_unit + part.units || units.end <= part.first_unit) continue;
      const int begin = part.column(units.begin - part.first_unit), end = part.column(units.end - part.first_unit);
      if (begin >= end) continue;
      for (const int preparation : part.needs) have(preparation, mine);
      part.work(mine, begin, end);
    }
  }

  std::vector<Work> preparations_;
  Work end_;
  int preparing_ = 0, all_ = 0;  // units
  std::vector<Part> parts_;
  std::deque<Place> places_;
  int threads_ = 0;  // of the last call
  std::atomic<int> undone_{0};
  tbb::task_group helpers_;
};

}  // namespace dalembert
