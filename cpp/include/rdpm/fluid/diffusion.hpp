// Diffusion in large stable steps: the Runge-Kutta-Legendre scheme of second order with a constant source.
//
// Meyer, Balsara, Aslam, J. Comput. Phys. 257 (2014) 594, eqs 16-17. Written for the change D = Y - Y_0: with
// M = nu lap(Y_0) + source, every stage is D_j = mu_j D_{j-1} + nu_j D_{j-2} + dt (mu~_j nu lap(D_{j-1}) +
// (mu~_j + gamma~_j) M), so that only M is read, moving walls drop out, and a thread can recompute its
// neighbours' edge planes by itself. All stages run over a few planes while these are in cache: stage j is
// one plane behind stage j-1. D_1 is M times a number, and is never stored.
#pragma once
#include <omp.h>

#include <algorithm>
#include <array>
#include <vector>

#include "rdpm/grid/grid.hpp"

namespace rdpm {

struct Stage {
    double last, before, laplacian,
        rate;  // weights of D_{j-1}, D_{j-2}, dt nu lap(D_{j-1}) [nu excluded], dt M
};

constexpr int most_stages = 10000;

inline std::vector<Stage> legendre_stages(int stages, double dt) {
    const auto b = [](int j) { return j < 2 ? 1.0 / 3.0 : (j * j + j - 2.0) / (2.0 * j * (j + 1.0)); };
    const double w1 = 4.0 / (static_cast<double>(stages) * stages + stages - 2.0);
    std::vector<Stage> all{{0.0, 0.0, 0.0, b(1) * w1 * dt}};
    for (int j = 2; j <= stages; ++j) {
        const double mu = (2.0 * j - 1.0) / j * b(j) / b(j - 1);
        const double nu = -(j - 1.0) / j * b(j) / b(j - 2);
        const double mu_tilde = mu * w1, gamma_tilde = -(1.0 - b(j - 1)) * mu_tilde;
        all.push_back({mu, nu, mu_tilde * dt, (mu_tilde + gamma_tilde) * dt});
    }
    return all;
}

// Weights with which the planes below and above enter, and whether they are the plane itself (mirrored at a
// side).
struct EndPlane {
    bool is_self;
    double weight;
};

inline EndPlane end_plane(const Grid& g, int k, int neighbour, int component) {
    const bool is_below = neighbour < 1, is_inside = !is_below && neighbour <= g.nz();
    if (is_inside || !g.has_face(2, is_below ? 0 : 1)) {
        // The top face of a walled box is the wall: its change is zero.
        const bool at_wall = component == face_z && neighbour == g.nz() && g.has_face(2, 1);
        return {at_wall, at_wall ? 0.0 : 1.0};
    }
    if (component == face_z) return {true, 0.0};
    return {true, mirror(g, k == 1 ? 4 : 5, component).sign};
}

// velocity += D_s for one component, of two stages or more. The rate's halo is filled, as a change's.
// `scratch`: 3 (stages-2) planes a thread. `beyond`: of a slab, stages-1 planes of the rate below it and as
// many above.
inline void stabilised_diffusion(const Grid& g, double* velocity, double* rate, int component, double nu,
                                 const std::vector<Stage>& stage, double* scratch,
                                 std::array<double*, 2> beyond) {
    const int stages = static_cast<int>(stage.size()), nx = g.nx(), ny = g.ny(), nz = g.nz();
    const std::size_t plane = g.plane(), row = g.row();
    const double cx = nu / (g.spacing[0] * g.spacing[0]), cy = nu / (g.spacing[1] * g.spacing[1]),
                 cz = nu / (g.spacing[2] * g.spacing[2]);
    const int last_plane = component == face_z ? g.last_face(2) : nz;
    const bool wraps = g.wraps(2);
    const int lowest = g.has_face(2, 0) ? 1 : 1 - stages,
              highest = g.has_face(2, 1) ? last_plane : nz + stages;
    const int threads = std::min(g.threads, nz);
    const double first_weight = stage[0].rate;  // D_1 = first_weight M
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        auto [first, last] = share_of(nz, me, team);
        for (int k = first; k < last; ++k) fill_plane_halo(g, rate + k * plane, component, Walls::at_rest);
        for (int side = 0; g.is_slab() && me == 0 && side < 2; ++side)
            for (int k = 0; g.joined[side] && k < stages - 1; ++k)
                fill_plane_halo(g, beyond[side] + k * plane, component, Walls::at_rest);
#pragma omp barrier
        last = std::min(last, last_plane + 1);
        double* mine = scratch + static_cast<std::size_t>(3 * (stages - 2)) * plane * me;
        const auto rate_plane = [&](int k) {
            if (k < 1 && g.joined[0]) return beyond[0] + (k + stages - 2) * plane;
            if (k > nz && g.joined[1]) return beyond[1] + (k - nz - 1) * plane;
            return rate + (wraps ? (((k - 1) % nz + nz) % nz) + 1 : k) * plane;
        };
        const auto ring = [&](int j, int k) {  // plane k of D_j, 2 <= j < stages
            return mine + (3 * (j - 2) + ((k % 3) + 3) % 3) * plane;
        };
        for (int tick = first - (stages - 2); tick < last + stages - 2; ++tick) {
            for (int j = 2; j <= stages; ++j) {
                const int k = tick - (j - 2), reach = stages - j;
                if (k < first - reach || k >= last + reach) continue;
                if (!wraps && (k < lowest || k > highest)) continue;
                const Stage s = stage[j - 1];
                const EndPlane lo = end_plane(g, k, k - 1, component), hi = end_plane(g, k, k + 1, component);
                const double* m = rate_plane(k);
                const double* c = j == 2 ? m : ring(j - 1, k);
                const double* below = lo.is_self ? c : j == 2 ? rate_plane(k - 1) : ring(j - 1, k - 1);
                const double* above = hi.is_self ? c : j == 2 ? rate_plane(k + 1) : ring(j - 1, k + 1);
                // The second stage's neighbours are M itself; the third's D_{j-2} is.
                const double of_last = j == 2 ? first_weight : 1.0;
                const double of_rate = s.rate + (j == 3 ? s.before * first_weight : 0.0);
                const double bx = of_last * s.laplacian * cx, by = of_last * s.laplacian * cy,
                             bz = of_last * s.laplacian * cz;
                const double centre = of_last * s.last - 2.0 * (bx + by + bz), b_lo = bz * lo.weight,
                             b_hi = bz * hi.weight;
                const auto change = [&](std::size_t i) {
                    return centre * c[i] + bx * (c[i + 1] + c[i - 1]) + by * (c[i + row] + c[i - row]) +
                           b_lo * below[i] + b_hi * above[i] + of_rate * m[i];
                };
                if (j == stages) {
                    double* out = velocity + k * plane;
                    const double* before = j > 3 ? ring(j - 2, k) : c;
                    const double w_before = j > 3 ? s.before : 0.0;
                    for (int y = 1; y <= ny; ++y) {
                        const std::size_t o = y * row;
#pragma omp simd
                        for (int x = 1; x <= nx; ++x) out[o + x] += change(o + x) + w_before * before[o + x];
                    }
                    continue;
                }
                double* out = ring(j, k);
                if (j > 3) {
                    const double* before = ring(j - 2, k);
                    const double w_before = s.before;
                    for (int y = 1; y <= ny; ++y) {
                        const std::size_t o = y * row;
#pragma omp simd
                        for (int x = 1; x <= nx; ++x) out[o + x] = change(o + x) + w_before * before[o + x];
                    }
                } else {
                    for (int y = 1; y <= ny; ++y) {
                        const std::size_t o = y * row;
#pragma omp simd
                        for (int x = 1; x <= nx; ++x) out[o + x] = change(o + x);
                    }
                }
                fill_plane_halo(g, out, component, Walls::at_rest);
            }
        }
    }
}

}  // namespace rdpm
