// What the next body's markers will touch of the three velocity components, fetched while the present body is
// worked on: the fields of many bodies do not fit in a core's cache, one body's part of them does.
#pragma once
#include <algorithm>
#include <cmath>
#include <utility>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/grid/grid.hpp"

namespace rdpm {

class Prefetch {
   public:
    Prefetch(const Grid& g, const VelocityArrays& q, int first_plane, int last_plane)
        : g_(g), field_{q.u, q.v, q.w}, first_(first_plane), last_(last_plane) {}

    // The ellipsoid about the cells from `lower` to `upper`, unwrapped, and `margin` cells further; in so many calls.
    void aim(const std::int32_t* lower, const std::int32_t* upper, float margin, int calls) {
        for (int d = 0; d < 3; ++d) {
            middle_[d] = 0.5f * (lower[d] + upper[d]);
            reach_[d] = 0.5f * (upper[d] - lower[d]) + margin;
        }
        low_[0] = lower[1] - 2, high_[0] = upper[1] + 1;
        low_[1] = lower[2] - 2, high_[1] = upper[2] + 1;
        j_ = low_[0], k_ = low_[1];
        rows_ = (high_[0] - low_[0] + 1) * (high_[1] - low_[1] + 1);
        calls_ = std::max(1, calls);
        owed_ = 0;
        at_ = end_ = after_at_ = after_end_ = nullptr;
    }
    // An array of the body's markers as well.
    void add(const double* values, std::size_t count) {
        after_at_ = std::exchange(at_, values);
        after_end_ = std::exchange(end_, values + count);
    }
    [[gnu::always_inline]] void advance() {
        for (owed_ += rows_; owed_ >= calls_ && k_ <= high_[1]; owed_ -= calls_) {
            fetch_row();
            if (++j_ > high_[0]) j_ = low_[0], ++k_;
        }
        if (at_ < end_) {
            __builtin_prefetch(at_, 0, 2);
            at_ += 8;
            if (at_ >= end_) at_ = std::exchange(after_at_, nullptr), end_ = std::exchange(after_end_, nullptr);
        }
    }

   private:
    // The row's part within the ellipsoid about the markers.
    [[gnu::always_inline]] void fetch_row() {
        const float y = (j_ - middle_[1]) / reach_[1], z = (k_ - middle_[2]) / reach_[2],
                    rest = 1.0f - y * y - z * z;
        const int k = wrapped(2, k_);
        if (rest <= 0.0f || k < first_ || k >= last_) return;
        const float half = reach_[0] * std::sqrt(rest);
        const std::size_t row = wrapped(1, j_) * g_.row() + k * g_.plane();
        const int begin = static_cast<int>(middle_[0] - half), end = static_cast<int>(middle_[0] + half) + 1;
        for (int i = begin; i < end + 8; i += 8) {
            const std::size_t at = row + wrapped(0, std::min(i, end));
            for (const double* field : field_) __builtin_prefetch(field + at, 0, 2);
        }
    }
    int wrapped(int d, int i) const {
        if (g_.boundary[d] != periodic) return std::clamp(i, 0, g_.cells[d] + 1);
        return i < 1 ? i + g_.cells[d] : i > g_.cells[d] ? i - g_.cells[d] : i;
    }

    const Grid& g_;
    const double* field_[3];
    int first_, last_, low_[2] = {0, 0}, high_[2] = {-1, -1}, j_ = 0, k_ = 0, rows_ = 0, calls_ = 1, owed_ = 0;
    float middle_[3], reach_[3];
    const double *at_ = nullptr, *end_ = nullptr, *after_at_ = nullptr, *after_end_ = nullptr;
};

}  // namespace rdpm
