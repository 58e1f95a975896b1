// The fluid inside a sphere: its mean velocity and mean angular velocity, by the volume fraction of the
// grid's faces.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/grid/grid.hpp"
#include "rdpm/particles/marker_stencils.hpp"

namespace rdpm {

typedef double Eight __attribute__((vector_size(64), aligned(8), may_alias));

inline double sum_of(const Eight& v) {
    return ((v[0] + v[1]) + (v[2] + v[3])) + ((v[4] + v[5]) + (v[6] + v[7]));
}

// Sums over faces within a sphere, eight at a time: of weight and weight * value, with x, y and their
// squares.
struct PlaneSums {
    Eight weight{}, value{}, value_x{}, value_y{}, x_square{}, y_square{};
};

// A row of `count` faces from x on, its height y and squared distance yz. The fraction inside falls from one
// to nothing over one cell, linearly in the squared distance, which needs no root: 0.5 + (square - r^2)
// slope.
inline void add_row(const double* q, int count, double x, double dx, double y, double yz, double square,
                    double slope, PlaneSums& sums) {
    const Eight lane{0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0}, none{}, all = none + 1.0;
    const double on_axis = 0.5 + (square - yz) * slope;
    Eight weight{}, values{};
    for (int n = 0; n < count; n += 8) {
        // The last eight end with the row, so that what follows, which may not be in the cache, is read of
        // short rows only; none is counted twice.
        const int i = std::max(0, std::min(n, count - 8));
        const Eight at = (x + i * dx) + lane * dx, at_square = at * at;
        Eight inside = on_axis - at_square * slope;
        inside = inside < none ? none : inside;
        inside = inside > all ? all : inside;
        if (i < n) inside = lane < none + (n - i) ? none : inside;
        if (count < 8) inside = lane < none + count ? inside : none;
        const Eight value = inside * *reinterpret_cast<const Eight*>(q + i);
        weight += inside;
        values += value;
        sums.value_x += value * at;
        sums.x_square += inside * at_square;
    }
    sums.weight += weight;
    sums.value += values;
    sums.value_y += values * y;
    sums.y_square += weight * (y * y);
}

// Adds one component's share of a body's mean (3), weight (3), moment (3) and squared arm (3).
inline void add_component(const Grid& g, const double* field, int c, const double* centre, double radius,
                          Prefetch& ahead, double* mean, double* weight, double* moment, double* arm_square) {
    const double width = std::cbrt(g.volume()), square = radius * radius, slope = 0.5 / (radius * width),
                 reach = std::sqrt(square + radius * width);
    int lower[3], upper[3];
    double origin[3];  // coordinate of index 0 of this component, relative to the centre
    for (int d = 0; d < 3; ++d) {
        origin[d] = (d == c ? 0.0 : -0.5 * g.spacing[d]) - centre[d];
        lower[d] = static_cast<int>(std::ceil((-reach - origin[d]) / g.spacing[d]));
        upper[d] = static_cast<int>(std::floor((reach - origin[d]) / g.spacing[d]));
        if (g.boundary[d] != periodic) {
            lower[d] = std::max(lower[d], d == c ? 0 : 1);
            upper[d] = std::min(upper[d], g.whole(d));
        }
    }
    const auto wrapped = [&](int d, int i) {
        if (g.boundary[d] != periodic) return i;
        return i < 1 ? i + g.whole(d) : i > g.whole(d) ? i - g.whole(d) : i;
    };
    // Indices within `half` of the centre, rounded outwards: what lies outside the sphere has no weight.
    const auto within = [&](int d, double half) {
        return std::pair(std::max(lower[d], static_cast<int>((-half - origin[d]) / g.spacing[d])),
                         std::min(upper[d], static_cast<int>((half - origin[d]) / g.spacing[d]) + 1));
    };
    const double dx = g.spacing[0];
    // The face at the wall below a slab is its own.
    const int lowest = c == 2 && g.has_face(2, 0) ? 0 : 1;
    for (int k = lower[2]; k <= upper[2]; ++k) {
        const int here = g.plane_here(wrapped(2, k));
        if (g.is_slab() && (here < lowest || here > g.nz())) continue;
        const double z = origin[2] + k * g.spacing[2], half = std::sqrt(std::max(0.0, reach * reach - z * z));
        const double* plane = field + here * g.plane();
        // All rows of a plane are read as far as its longest: the processor predicts loops of the same
        // length.
        const auto [first, last] = within(0, half);
        const auto [first_row, last_row] = within(1, half);
        PlaneSums sums;
        for (int j = first_row; j <= last_row; ++j) {
            const double y = origin[1] + j * g.spacing[1], yz = y * y + z * z;
            ahead.advance();
            const double* row = plane + wrapped(1, j) * g.row();
            // A row that crosses a periodic face is read in two pieces.
            for (int i = first; i <= last;) {
                const int at = wrapped(0, i);
                const int count =
                    g.boundary[0] == periodic ? std::min(last - i, g.nx() - at) + 1 : last - i + 1;
                add_row(row + at, count, origin[0] + i * dx, dx, y, yz, square, slope, sums);
                i += count;
            }
        }
        const double value = sum_of(sums.value), w = sum_of(sums.weight), value_x = sum_of(sums.value_x),
                     value_y = sum_of(sums.value_y), x_square = sum_of(sums.x_square),
                     y_square = sum_of(sums.y_square);
        mean[c] += value;
        weight[c] += w;
        // Rotation about e moves component c by +arm_f, about f by -arm_e (c, e, f right-handed).
        if (c == 0) {
            moment[1] += z * value;
            moment[2] -= value_y;
            arm_square[1] += z * z * w;
            arm_square[2] += y_square;
        } else if (c == 1) {
            moment[2] += value_x;
            moment[0] -= z * value;
            arm_square[2] += x_square;
            arm_square[0] += z * z * w;
        } else {
            moment[0] += value_y;
            moment[1] -= value_x;
            arm_square[0] += y_square;
            arm_square[1] += x_square;
        }
    }
}

// Whether the fluid about a sphere is read with one wrapping of the indices across periodic faces.
inline bool is_within_a_period(const Grid& g, const double* centre, double radius) {
    if (!(radius > 0.0)) return false;
    const double reach = std::sqrt(radius * radius + radius * std::cbrt(g.volume()));
    for (int d = 0; d < 3; ++d) {
        const double lower = (centre[d] - reach) / g.spacing[d], upper = (centre[d] + reach) / g.spacing[d];
        if (!(lower > 1.0 - g.whole(d) && upper < 2.0 * g.whole(d) - 1.0)) return false;
    }
    return true;
}

// Sums over the fluid within `radius` of each centre, (bodies, 12): velocity (3) and its weight (3), moment
// of velocity (3) and squared arm (3), whose ratios are mean velocity and angular velocity. The markers are
// those of the same bodies: they know what to fetch ahead, and in which order.
inline void inner_sums(const Grid& g, const VelocityView& q, const StencilSet& set, const double* position,
                       const double* radius, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    const int bodies = set.bodies();
#pragma omp parallel num_threads(g.threads) if (set.count() > few_markers)
    {
        Prefetch ahead(q);
        const int me = omp_get_thread_num(), team = omp_get_num_threads(),
                  begin = static_cast<int>(static_cast<long>(bodies) * me / team),
                  end = static_cast<int>(static_cast<long>(bodies) * (me + 1) / team);
        for (int n = begin; n < end; ++n) {
            const int b = set.body[n].id;
            if (n + 1 < end) {
                const BodyMarkers& next = set.body[n + 1];
                const int across = next.box.upper[2] - next.box.lower[2] + 1,
                          rows = 2 * across * across;  // of a ball
                ahead.aim(set.line.data() + next.first_line, set.line.data() + next.last_line, rows);
            }
            double sums[12] = {};
            for (int c = 0; c < 3; ++c)
                add_component(g, field[c], c, position + 3 * b, radius[b], ahead, sums, sums + 3, sums + 6,
                              sums + 9);
            std::copy_n(sums, 12, out + 12 * b);
        }
    }
}

}  // namespace rdpm
