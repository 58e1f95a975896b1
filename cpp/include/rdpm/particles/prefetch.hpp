// What the next body will touch of the three velocity components, fetched while the present body is worked
// on: the fields of many bodies do not fit in a core's cache, one body's part of them does.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/grid/grid.hpp"

namespace rdpm {

// A box of cells, unwrapped.
struct CellBox {
    std::int32_t lower[3], upper[3];
    // The most lines that `find_lines` gives for what is within `reach` of it.
    std::size_t most_lines(int reach) const {
        const auto width = [&](int d) {
            return static_cast<std::size_t>(upper[d] - lower[d] + 1 + 2 * reach);
        };
        return width(2) * width(1) * (width(0) / 8 + 3);
    }
};

// Offsets in a field, no more than eight values apart along a row, of the points at most `reach` cells along
// each direction from the ellipsoid in the box; returns their number.
inline int find_lines(const Grid& g, const CellBox& box, int reach, std::int32_t* out) {
    float middle[3], axis[3];
    for (int d = 0; d < 3; ++d) {
        middle[d] = 0.5f * (box.lower[d] + box.upper[d]);
        axis[d] = 0.5f * (box.upper[d] - box.lower[d]) + 0.5f;
    }
    const auto wrapped = [&](int d, int i) {
        if (!g.wraps(d)) return std::clamp(i, 0, g.cells[d] + 1);
        return i < 1 ? i + g.cells[d] : i > g.cells[d] ? i - g.cells[d] : i;
    };
    // Square of the coordinate of the nearest point within `reach`, over the axis.
    const auto nearest = [&](int d, int i) {
        const float x = std::max(0.0f, std::abs(i - middle[d]) - reach) / axis[d];
        return x * x;
    };
    int count = 0;
    for (int k = box.lower[2] - reach; k <= box.upper[2] + reach; ++k) {
        const auto plane = static_cast<std::int32_t>(wrapped(2, k) * g.plane());
        for (int j = box.lower[1] - reach; j <= box.upper[1] + reach; ++j) {
            const float rest = 1.0f - nearest(1, j) - nearest(2, k);
            if (rest <= 0.0f) continue;
            const float half = axis[0] * std::sqrt(rest) + reach;
            const auto row = static_cast<std::int32_t>(plane + wrapped(1, j) * g.row());
            const int begin = static_cast<int>(middle[0] - half),
                      end = static_cast<int>(middle[0] + half) + 1;
            for (int i = begin; i < end + 8; i += 8) out[count++] = row + wrapped(0, std::min(i, end));
        }
    }
    return count;
}

// Fetches a little at each `advance`: in a burst the requests would wait for each other, and what follows for
// them. Inlined always: a call that only fetches is removed as one without effect.
class Prefetch {
  public:
    explicit Prefetch(const VelocityView& q) : u_(q.u), v_(q.v), w_(q.w) {}

    // Lines of the fields, in so many calls.
    void aim(const std::int32_t* line, const std::int32_t* end, int calls) {
        line_ = line;
        line_end_ = end;
        a_call_ = static_cast<int>(end - line) / std::max(1, calls) + 1;
        at_ = at_end_ = later_ = later_end_ = nullptr;
    }
    // An array as well; two at most.
    void add(const double* values, std::size_t count) {
        later_ = std::exchange(at_, values);
        later_end_ = std::exchange(at_end_, values + count);
    }
    [[gnu::always_inline]] void advance() {
        for (int n = 0; n < a_call_ && line_ < line_end_; ++n, ++line_) {
            __builtin_prefetch(u_ + *line_, 0, 2);
            __builtin_prefetch(v_ + *line_, 0, 2);
            __builtin_prefetch(w_ + *line_, 0, 2);
        }
        if (at_ < at_end_) {
            __builtin_prefetch(at_, 0, 2);
            at_ += 8;
            if (at_ >= at_end_)
                at_ = std::exchange(later_, nullptr), at_end_ = std::exchange(later_end_, nullptr);
        }
    }

  private:
    const double *u_, *v_, *w_;
    const std::int32_t *line_ = nullptr, *line_end_ = nullptr;
    int a_call_ = 1;
    const double *at_ = nullptr, *at_end_ = nullptr, *later_ = nullptr, *later_end_ = nullptr;
};

}  // namespace rdpm
