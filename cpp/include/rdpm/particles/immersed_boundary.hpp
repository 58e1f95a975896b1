// Markers and grid: interpolation and spreading, exact adjoints, and the sums over each body's markers.
//
// A marker's stencils are made once a step. Spreading is shared by planes: markers are visited in the order
// of their lowest plane, every thread adds only to the planes it owns, so no two threads touch a value and
// the order of a sum is fixed.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstdint>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/particles/delta.hpp"

namespace rdpm {

// Stencils of one marker: [0] at centres, [1] on faces, along each direction, for each component they serve.
// Component c needs faces along c and centres elsewhere; at a side the sign depends on the component only
// through c == d.
struct MarkerStencils {
    Stencil centre_of[3], face_of[3];
    const Stencil& along(int d, int component) const { return d == component ? face_of[d] : centre_of[d]; }
};

inline void make_stencils(const Grid& g, const double* position, int first, int last, MarkerStencils* out) {
#pragma omp parallel for num_threads(g.threads) schedule(static) if (last - first > 256)
    for (int m = first; m < last; ++m)
        for (int d = 0; d < 3; ++d) {
            const double x = position[3 * m + d];
            out[m].centre_of[d] = stencil_along(g, d, x, d == 0 ? face_y : face_x);
            out[m].face_of[d] = stencil_along(g, d, x, d);
        }
}

// What moving walls add to the interpolated component: the folded weights times the walls' speed.
inline double wall_part(const Grid& g, const MarkerStencils& s, int component) {
    double sum = 0.0;
    for (int d = 0; d < 3; ++d)
        if (d != component)
            for (int side = 0; side < 2; ++side)
                if (s.centre_of[d].wall[side] != 0.0)
                    sum += s.centre_of[d].wall[side] * g.speed_of_side(2 * d + side, component);
    return sum;
}

inline double interpolate_component(const Grid& g, const double* q, const MarkerStencils& s, int component) {
    const Stencil &x = s.along(0, component), &y = s.along(1, component), &z = s.along(2, component);
    double sum = 0.0;
    for (int c = 0; c < 3; ++c) {
        double in_plane = 0.0;
        const double* plane = q + z.index[c] * g.plane();
        for (int b = 0; b < 3; ++b) {
            const double* r = plane + y.index[b] * g.row();
            in_plane += y.weight[b] * (x.weight[0] * r[x.index[0]] + x.weight[1] * r[x.index[1]] +
                                       x.weight[2] * r[x.index[2]]);
        }
        sum += z.weight[c] * in_plane;
    }
    return sum;
}

// Velocity at the markers, (markers, 3).
inline void interpolate(const Grid& g, const VelocityArrays& q, const MarkerStencils* stencils, int markers,
                        double* out) {
    const double* field[3] = {q.u, q.v, q.w};
#pragma omp parallel for num_threads(g.threads) schedule(static) if (markers > 256)
    for (int m = 0; m < markers; ++m)
        for (int c = 0; c < 3; ++c)
            out[3 * m + c] =
                interpolate_component(g, field[c], stencils[m], c) + wall_part(g, stencils[m], c);
}

// Order of the markers by the plane of their cell, a counting sort; `start`: nz + 3 offsets into it.
inline void order_by_plane(const Grid& g, const MarkerStencils* stencils, int markers, std::int32_t* order,
                           std::int32_t* start) {
    std::fill_n(start, g.nz() + 3, 0);
    for (int m = 0; m < markers; ++m) ++start[stencils[m].centre_of[2].index[1] + 1];
    for (int k = 0; k < g.nz() + 2; ++k) start[k + 1] += start[k];
    for (int m = 0; m < markers; ++m) order[start[stencils[m].centre_of[2].index[1]]++] = m;
    for (int k = g.nz() + 2; k > 0; --k) start[k] = start[k - 1];
    start[0] = 0;
}

// q += factor * sum over markers of value * volume * delta: the adjoint of interpolate.
inline void spread(const Grid& g, const VelocityArrays& q, const MarkerStencils* stencils, int markers,
                   const std::int32_t* order, const double* value, const double* volume, double factor) {
    double* field[3] = {q.u, q.v, q.w};
    const double per_cell = factor / g.volume();
    const int threads = markers > 256 ? std::min(g.threads, g.nz()) : 1;
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        // Equal numbers of markers, cut between planes.
        const auto cut = [&](int t) {
            if (t == 0) return 1;
            if (t == team) return g.nz() + 1;
            return stencils[order[static_cast<long>(markers) * t / team]].centre_of[2].index[1];
        };
        const int first = cut(me), last = cut(me + 1);
        for (int n = 0; n < markers; ++n) {
            const int m = order[n];
            const MarkerStencils& s = stencils[m];
            for (int c = 0; c < 3; ++c) {
                const Stencil &x = s.along(0, c), &y = s.along(1, c), &z = s.along(2, c);
                const double strength = per_cell * volume[m] * value[3 * m + c];
                for (int kk = 0; kk < 3; ++kk) {
                    if (z.index[kk] < first || z.index[kk] >= last) continue;
                    double* plane = field[c] + z.index[kk] * g.plane();
                    for (int jj = 0; jj < 3; ++jj) {
                        double* r = plane + y.index[jj] * g.row();
                        const double f = strength * z.weight[kk] * y.weight[jj];
                        for (int ii = 0; ii < 3; ++ii) r[x.index[ii]] += f * x.weight[ii];
                    }
                }
            }
        }
    }
}

// Vectors of each body's markers turned by its unit quaternion (w, x, y, z), or back; `centre` is added if
// given.
inline void turn_vectors(int bodies, const std::int32_t* first, const double* orientation,
                         const double* centre, const double* in, bool back, int threads, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        const double *o = orientation + 4 * b, w = o[0], x = back ? -o[1] : o[1], y = back ? -o[2] : o[2],
                     z = back ? -o[3] : o[3];
        const double turn[3][3] = {
            {1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)},
            {2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)},
            {2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)}};
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double v[3] = {in[3 * m], in[3 * m + 1], in[3 * m + 2]};
            for (int c = 0; c < 3; ++c)
                out[3 * m + c] = turn[c][0] * v[0] + turn[c][1] * v[1] + turn[c][2] * v[2] +
                                 (centre ? centre[3 * b + c] : 0.0);
        }
    }
}

// Of each body: sum of volume * value, sum of arm x (volume * value), in the order of its markers. (bodies,
// 6).
inline void sum_over_markers(int bodies, const std::int32_t* first, const double* arm, const double* volume,
                             const double* value, int threads, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        double s[6] = {};
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double *r = arm + 3 * m, fx = volume[m] * value[3 * m], fy = volume[m] * value[3 * m + 1],
                         fz = volume[m] * value[3 * m + 2];
            s[0] += fx;
            s[1] += fy;
            s[2] += fz;
            s[3] += r[1] * fz - r[2] * fy;
            s[4] += r[2] * fx - r[0] * fz;
            s[5] += r[0] * fy - r[1] * fx;
        }
        std::copy_n(s, 6, out + 6 * b);
    }
}

// change = rigid velocity of the body - velocity of the fluid there; force += change / dt.
inline void rigid_change(int bodies, const std::int32_t* first, const double* arm, const double* velocity,
                         const double* spin, const double* fluid, double inverse_dt, int threads,
                         double* change, double* force) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        const double *v = velocity + 3 * b, *o = spin + 3 * b;
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double* r = arm + 3 * m;
            const double rigid[3] = {v[0] + o[1] * r[2] - o[2] * r[1], v[1] + o[2] * r[0] - o[0] * r[2],
                                     v[2] + o[0] * r[1] - o[1] * r[0]};
            for (int c = 0; c < 3; ++c) {
                change[3 * m + c] = rigid[c] - fluid[3 * m + c];
                force[3 * m + c] += inverse_dt * change[3 * m + c];
            }
        }
    }
}

}  // namespace rdpm
