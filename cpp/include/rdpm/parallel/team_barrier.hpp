// A barrier of few threads that meet often.
#pragma once
#include <atomic>

namespace rdpm {

// Waits for a small team: a short spin, then the processor is given away.
class TeamBarrier {
  public:
    void wait(int team) {
        if (team == 1) return;
        const unsigned turn = turn_.load(std::memory_order_relaxed);
        if (count_.fetch_add(1, std::memory_order_acq_rel) == team - 1) {
            count_.store(0, std::memory_order_relaxed);
            turn_.store(turn + 1, std::memory_order_release);
            turn_.notify_all();
            return;
        }
        for (int spin = 0; spin < 2000; ++spin)
            if (turn_.load(std::memory_order_acquire) != turn) return;
        turn_.wait(turn, std::memory_order_acquire);
    }

  private:
    alignas(64) std::atomic<int> count_{0};
    alignas(64) std::atomic<unsigned> turn_{0};
};

}  // namespace rdpm
