// The regularised delta: three points wide (Roma, Peskin, Berger, J. Comput. Phys. 153 (1999) 509), folded at
// the walls.
#pragma once
#include <cmath>

#include "rdpm/grid/grid.hpp"

namespace rdpm {

// Weights of the three points around s (in cells), the middle one being the nearest: they sum to one and
// their first moment is s, so one square root gives all three.
inline void roma_weights(double s, int middle, double* weight) {
    const double r = s - middle;
    weight[1] = (1.0 + std::sqrt(1.0 - 3.0 * r * r)) / 3.0;
    weight[0] = 0.5 * (1.0 - weight[1] - r);
    weight[2] = 0.5 * (1.0 - weight[1] + r);
}

// Three indices and weights along one direction; `wall`: what a moving wall's speed enters with.
struct Stencil {
    int index[3];
    double weight[3];
    double wall[2];  // lower, upper face
};

// Stencil of a point at x along direction d for values on faces (of d) or at centres. Folded: a halo value is
// sign * inner + (1 - sign) * wall speed, so its weight goes to the inner value; a periodic index is wrapped.
// `location`: the component whose values these are, which decides the sign at a side. In a slab, indices are
// its own and what lies in planes of others has no weight.
inline Stencil stencil_along(const Grid& g, int d, double x, int location) {
    const int n = g.whole(d);
    const bool on_faces = d == location;
    const double s = x / g.spacing[d] + (on_faces ? 0.0 : 0.5);  // in index units: face i at i, centre i at i
    const int middle = static_cast<int>(std::floor(s + 0.5));
    Stencil out{};
    double weights[3];
    roma_weights(s, middle, weights);
    for (int a = 0; a < 3; ++a) {
        int i = middle - 1 + a;
        double weight = weights[a];
        if (g.boundary[d] == periodic) {
            while (i < 1) i += n;
            while (i > n) i -= n;
        } else if (on_faces) {
            // Odd about the wall, where the face itself is at rest; a face at or beyond index n mirrors to 2n
            // - i.
            if (i == 0 || i == n) {
                weight = 0.0;
                i = 1;
            } else if (i < 0 || i > n) {
                i = i < 0 ? -i : 2 * n - i;
                weight = -weight;
            }
            if (i < 1 || i > n) weight = 0.0, i = 1;
        } else if (i < 1 || i > n) {
            const int side = i < 1 ? 0 : 1;
            const double sign = mirror(g, 2 * d + side, location).sign;
            out.wall[side] += weight * (1.0 - sign);
            i = i < 1 ? 1 - i : 2 * n + 1 - i;
            weight *= sign;
            if (i < 1 || i > n) weight = 0.0, i = 1;
        }
        if (d == 2 && g.is_slab()) {
            i = g.plane_here(i);
            if (i < 1 || i > g.nz()) weight = 0.0, i = 1;
        }
        out.index[a] = i;
        out.weight[a] = weight;
    }
    return out;
}

}  // namespace rdpm
