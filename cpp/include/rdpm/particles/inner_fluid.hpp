// The fluid inside a sphere: its mean velocity and mean spin, by the volume fraction of the grid's faces.
#pragma once
#include <algorithm>
#include <cmath>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/grid/grid.hpp"

namespace rdpm {

// Sums over one row of faces within a sphere: weight, weight * value, weight * value * x, weight * x^2.
struct RowSums {
    double weight = 0.0, value = 0.0, value_x = 0.0, x_square = 0.0;
};

// `yz`: squared distance of the row from the centre; `x`: of the first face. The fraction inside falls from
// one to nothing over one cell, linearly in the squared distance, which needs no root.
inline void add_row(const double* q, int count, double x, double dx, double yz, double square, double slope,
                    RowSums& sums) {
    double weight = 0.0, value = 0.0, value_x = 0.0, x_square = 0.0;
#pragma omp simd reduction(+ : weight, value, value_x, x_square)
    for (int i = 0; i < count; ++i) {
        const double at = x + i * dx;
        const double depth = 0.5 + (square - yz - at * at) * slope;
        const double inside = std::min(std::max(depth, 0.0), 1.0);
        weight += inside;
        value += inside * q[i];
        value_x += inside * q[i] * at;
        x_square += inside * at * at;
    }
    sums.weight += weight;
    sums.value += value;
    sums.value_x += value_x;
    sums.x_square += x_square;
}

// Adds one component's share of a body's mean (3), weight (3), moment (3) and squared arm (3).
inline void add_component(const Grid& g, const double* field, int c, const double* centre, double radius,
                          double* mean, double* weight, double* moment, double* arm_square) {
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
            upper[d] = std::min(upper[d], g.cells[d]);
        }
    }
    const auto wrapped = [&](int d, int i) {
        if (g.boundary[d] != periodic) return i;
        return i < 1 ? i + g.cells[d] : i > g.cells[d] ? i - g.cells[d] : i;
    };
    for (int k = lower[2]; k <= upper[2]; ++k) {
        const double z = origin[2] + k * g.spacing[2];
        const double* plane = field + wrapped(2, k) * g.plane();
        for (int j = lower[1]; j <= upper[1]; ++j) {
            const double y = origin[1] + j * g.spacing[1], yz = y * y + z * z;
            if (yz > reach * reach) continue;
            const double* row = plane + wrapped(1, j) * g.row();
            for (int i = lower[0]; i <= upper[0]; i += 8)
                __builtin_prefetch(row + 4 * g.row() + wrapped(0, i));
            RowSums s;
            // A row that crosses a periodic side is read in two pieces.
            for (int i = lower[0]; i <= upper[0];) {
                const int at = wrapped(0, i);
                const int count =
                    g.boundary[0] == periodic ? std::min(upper[0] - i, g.nx() - at) + 1 : upper[0] - i + 1;
                add_row(row + at, count, origin[0] + i * g.spacing[0], g.spacing[0], yz, square, slope, s);
                i += count;
            }
            mean[c] += s.value;
            weight[c] += s.weight;
            // Spin about e moves component c by +arm_f, about f by -arm_e (c, e, f right-handed).
            if (c == 0) {
                moment[1] += z * s.value;
                moment[2] -= y * s.value;
                arm_square[1] += z * z * s.weight;
                arm_square[2] += y * y * s.weight;
            } else if (c == 1) {
                moment[2] += s.value_x;
                moment[0] -= z * s.value;
                arm_square[2] += s.x_square;
                arm_square[0] += z * z * s.weight;
            } else {
                moment[0] += y * s.value;
                moment[1] -= s.value_x;
                arm_square[0] += y * y * s.weight;
                arm_square[1] += s.x_square;
            }
        }
    }
}

// Mean velocity (3) and spin (3) of the fluid within `radius` of each centre, (bodies, 6); sums normalised by
// their weights.
inline void inner_motion(const Grid& g, const VelocityArrays& q, int bodies, const double* position,
                         const double* radius, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
#pragma omp parallel for num_threads(g.threads) schedule(dynamic, 1) if (bodies > 1)
    for (int b = 0; b < bodies; ++b) {
        double mean[3] = {}, weight[3] = {}, moment[3] = {}, arm_square[3] = {};
        for (int c = 0; c < 3; ++c)
            add_component(g, field[c], c, position + 3 * b, radius[b], mean, weight, moment, arm_square);
        for (int c = 0; c < 3; ++c) {
            out[6 * b + c] = weight[c] > 0.0 ? mean[c] / weight[c] : 0.0;
            out[6 * b + 3 + c] = arm_square[c] > 0.0 ? moment[c] / arm_square[c] : 0.0;
        }
    }
}

}  // namespace rdpm
