// The fluid inside a sphere: its mean velocity and mean spin, by the volume fraction of the grid's faces.
#pragma once
#include <algorithm>
#include <cmath>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/grid/grid.hpp"

namespace rdpm {

// Mean velocity (3) and spin (3) of the fluid within `radius` of each centre, (bodies, 6). The fraction of a
// face's cell inside the sphere is taken linear in the distance over one cell; sums are normalised by their
// own weights.
inline void inner_motion(const Grid& g, const VelocityArrays& q, int bodies, const double* position,
                         const double* radius, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    const double mean_spacing = std::cbrt(g.volume());
#pragma omp parallel for num_threads(g.threads) schedule(dynamic, 1)
    for (int b = 0; b < bodies; ++b) {
        const double *x = position + 3 * b, a = radius[b], reach = a + 0.5 * mean_spacing;
        double mean[3] = {}, weight[3] = {}, moment[3] = {}, arm_square[3] = {};
        for (int c = 0; c < 3; ++c) {
            int lower[3], upper[3];
            double origin[3];  // coordinate of index 0 of this component, relative to the centre
            for (int d = 0; d < 3; ++d) {
                origin[d] = (d == c ? 0.0 : -0.5 * g.spacing[d]) - x[d];
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
            const int e = (c + 1) % 3, f = (c + 2) % 3;
            for (int k = lower[2]; k <= upper[2]; ++k) {
                const double z = origin[2] + k * g.spacing[2];
                const double* plane = field[c] + wrapped(2, k) * g.plane();
                for (int j = lower[1]; j <= upper[1]; ++j) {
                    const double y = origin[1] + j * g.spacing[1], yz = y * y + z * z;
                    if (yz > reach * reach) continue;
                    const double* r = plane + wrapped(1, j) * g.row();
                    for (int i = lower[0]; i <= upper[0]; ++i) {
                        const double arm[3] = {origin[0] + i * g.spacing[0], y, z};
                        const double inside =
                            std::clamp(0.5 + (a - std::sqrt(arm[0] * arm[0] + yz)) / mean_spacing, 0.0, 1.0);
                        const double v = inside * r[wrapped(0, i)];
                        mean[c] += v;
                        weight[c] += inside;
                        // spin about e takes +arm_f v_c, about f takes -arm_e v_c (right-handed c, e, f)
                        moment[e] += arm[f] * v;
                        moment[f] -= arm[e] * v;
                        arm_square[e] += inside * arm[f] * arm[f];
                        arm_square[f] += inside * arm[e] * arm[e];
                    }
                }
            }
        }
        for (int c = 0; c < 3; ++c) {
            out[6 * b + c] = weight[c] > 0.0 ? mean[c] / weight[c] : 0.0;
            out[6 * b + 3 + c] = arm_square[c] > 0.0 ? moment[c] / arm_square[c] : 0.0;
        }
    }
}

}  // namespace rdpm
