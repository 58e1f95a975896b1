// Sums and maxima over the flow, in chunks of a plane: the same for any number of threads.
#pragma once
#include <algorithm>
#include <cmath>
#include <vector>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/grid/grid.hpp"

namespace rdpm {

struct FlowMeasures {
    double cfl_rate = 0.0;    // max over cells of sum |u_d| / spacing_d [1/s]
    double square_sum = 0.0;  // sum of u^2 + v^2 + w^2 over faces [m^2/s^2]; not finite where anything is
};

// Of plane k of the cells, with the plane `face` of w beside it; `counted`: the plane of w whose squares are
// added.
inline FlowMeasures measure_plane(const Grid& g, const VelocityView& q, int k, int face, int counted) {
    const std::size_t row = g.row();
    const double *u = q.u + k * g.plane(), *v = q.v + k * g.plane();
    const double *w = q.w + face * g.plane(), *w_counted = q.w + counted * g.plane();
    const double ix = 1.0 / g.spacing[0], iy = 1.0 / g.spacing[1], iz = 1.0 / g.spacing[2];
    double most = 0.0, sum = 0.0;
    for (int j = 1; j <= g.ny(); ++j) {
        const std::size_t o = j * row;
#pragma omp simd reduction(max : most) reduction(+ : sum)
        for (int i = 1; i <= g.nx(); ++i) {
            const double a = u[o + i], b = v[o + i], c = w_counted[o + i];
            most = std::max(most, std::abs(a) * ix + std::abs(b) * iy + std::abs(w[o + i]) * iz);
            sum += a * a + b * b + c * c;
        }
    }
    return {most, sum};
}

// Largest |div u| over the cells [1/s]; needs current halos.
inline double largest_divergence(const Grid& g, VelocityView q) {
    const std::size_t row = g.row(), plane = g.plane();
    const double ix = 1.0 / g.spacing[0], iy = 1.0 / g.spacing[1], iz = 1.0 / g.spacing[2];
    double most = 0.0;
#pragma omp parallel for num_threads(g.threads) reduction(max : most) schedule(static)
    for (int k = 1; k <= g.nz(); ++k)
        for (int j = 1; j <= g.ny(); ++j) {
            const std::size_t o = k * plane + j * row;
            for (int i = 1; i <= g.nx(); ++i) {
                const std::size_t c = o + i;
                most = std::max(most, std::abs((q.u[c] - q.u[c - 1]) * ix + (q.v[c] - q.v[c - row]) * iy +
                                               (q.w[c] - q.w[c - plane]) * iz));
            }
        }
    return most;
}

// Cell-centred velocity and pressure for output: velocity (nz, ny, nx, 3), pressure (nz, ny, nx), single
// precision.
inline void cell_values(const Grid& g, VelocityView q, const double* p, double density, float* velocity,
                        float* pressure) {
    const std::size_t row = g.row(), plane = g.plane();
    const int nx = g.nx(), ny = g.ny();
#pragma omp parallel for num_threads(g.threads) schedule(static)
    for (int k = 1; k <= g.nz(); ++k)
        for (int j = 1; j <= ny; ++j) {
            const std::size_t o = k * plane + j * row;
            const std::size_t out = (static_cast<std::size_t>(k - 1) * ny + (j - 1)) * nx;
            for (int i = 1; i <= nx; ++i) {
                const std::size_t c = o + i;
                float* target = velocity + 3 * (out + i - 1);
                target[0] = static_cast<float>(0.5 * (q.u[c] + q.u[c - 1]));
                target[1] = static_cast<float>(0.5 * (q.v[c] + q.v[c - row]));
                target[2] = static_cast<float>(0.5 * (q.w[c] + q.w[c - plane]));
                pressure[out + i - 1] = static_cast<float>(density * p[c]);
            }
        }
}

}  // namespace rdpm
