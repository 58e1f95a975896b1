// Markers and grid: interpolation and spreading, exact adjoints, and the sums over each body's markers.
//
// A marker's stencils are made once a step: away from the sides three weights a direction and the place of
// the first point, beside them the folded ones. Spreading is shared by planes: markers are visited in the
// order of their plane, every thread adds only to the planes it owns, so no two threads touch a value and the
// order of a sum is fixed.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "rdpm/fluid/momentum.hpp"
#include "rdpm/particles/delta.hpp"

namespace rdpm {

// Stencils of a marker beside a side, for values at centres and on faces along each direction. Component c
// needs faces along c and centres elsewhere; at a side the sign depends on the component only through c == d.
struct FoldedStencils {
    Stencil centre_of[3], face_of[3];
    const Stencil& along(int d, int component) const { return d == component ? face_of[d] : centre_of[d]; }
};

struct MarkerStencils {
    double weight[2][3][3];    // [at centres, on faces][direction][point]
    std::int32_t first[3];     // offset of the first point, of each component
    std::int32_t plane, face;  // z index of the nearest centre, and of the first face
    std::int32_t folded;       // place in the list of folded stencils, or -1
};

struct StencilSet {
    std::vector<MarkerStencils> marker;
    std::vector<FoldedStencils> folded;
    std::vector<std::int32_t> first;            // markers first[b] to first[b + 1] belong to body b
    std::vector<std::int32_t> lowest, highest;  // planes a body's markers reach
    std::vector<std::int32_t> below;            // markers in planes below each plane
    int count() const { return static_cast<int>(marker.size()); }
};

// Four neighbouring doubles at once; the fourth enters with weight zero.
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));

inline Four three(const double* w) {
    return Four{w[0], w[1], w[2], 0.0};
}

inline bool make_stencils(const Grid& g, const double* x, MarkerStencils& out) {
    bool inside = true;
    int nearest[2][3];
    for (int d = 0; d < 3; ++d)
        for (int on_face = 0; on_face < 2; ++on_face) {
            const double s = x[d] / g.spacing[d] + (on_face ? 0.0 : 0.5);
            const int middle = static_cast<int>(std::floor(s + 0.5));
            nearest[on_face][d] = middle;
            roma_weights(s, middle, out.weight[on_face][d]);
            // one point further on is read, with weight zero; faces at and beyond a side are folded
            inside = inside && middle >= 2 && middle < g.cells[d] - 1;
        }
    const auto row = static_cast<std::int32_t>(g.row()), plane = static_cast<std::int32_t>(g.plane());
    for (int c = 0; c < 3; ++c)
        out.first[c] =
            (nearest[c == 2][2] - 1) * plane + (nearest[c == 1][1] - 1) * row + nearest[c == 0][0] - 1;
    out.plane = std::clamp(nearest[0][2], 1, g.nz());
    out.face = nearest[1][2] - 1;
    out.folded = -1;
    return inside;
}

// Stencils of all markers, and the planes that each body reaches.
inline void place(const Grid& g, const double* position, StencilSet& set) {
    const int markers = set.count(), bodies = static_cast<int>(set.first.size()) - 1;
#pragma omp parallel for num_threads(g.threads) schedule(static) if (markers > 256)
    for (int m = 0; m < markers; ++m)
        if (!make_stencils(g, position + 3 * m, set.marker[m])) set.marker[m].folded = 0;
    set.folded.clear();
    std::fill(set.below.begin(), set.below.end(), 0);
    for (int b = 0; b < bodies; ++b) {
        set.lowest[b] = g.nz();
        set.highest[b] = 1;
        for (int m = set.first[b]; m < set.first[b + 1]; ++m) {
            MarkerStencils& s = set.marker[m];
            ++set.below[s.plane + 1];
            if (s.folded < 0) {
                set.lowest[b] = std::min(set.lowest[b], s.plane - 2);
                set.highest[b] = std::max(set.highest[b], s.plane + 1);
                continue;
            }
            s.folded = static_cast<std::int32_t>(set.folded.size());
            FoldedStencils all;
            for (int d = 0; d < 3; ++d) {
                all.centre_of[d] = stencil_along(g, d, position[3 * m + d], d == 0 ? face_y : face_x);
                all.face_of[d] = stencil_along(g, d, position[3 * m + d], d);
            }
            for (const Stencil& z : {all.centre_of[2], all.face_of[2]})
                for (int k : z.index) {
                    set.lowest[b] = std::min(set.lowest[b], k);
                    set.highest[b] = std::max(set.highest[b], k);
                }
            set.folded.push_back(all);
        }
    }
    for (int k = 0; k < g.nz() + 2; ++k) set.below[k + 1] += set.below[k];
}

// What moving walls add to the interpolated component: the folded weights times the walls' speed.
inline double wall_part(const Grid& g, const FoldedStencils& s, int component) {
    double sum = 0.0;
    for (int d = 0; d < 3; ++d)
        if (d != component)
            for (int side = 0; side < 2; ++side)
                if (s.centre_of[d].wall[side] != 0.0)
                    sum += s.centre_of[d].wall[side] * g.speed_of_side(2 * d + side, component);
    return sum;
}

inline double interpolate_folded(const Grid& g, const double* q, const FoldedStencils& s, int component) {
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
    return sum + wall_part(g, s, component);
}

// The rows of a marker soon to come: the bodies' shells are too scattered for the processor to foresee.
constexpr int prefetch_ahead = 6;

inline void prefetch(const Grid& g, const VelocityArrays& q, const StencilSet& set, int m) {
    if (m >= set.count() || set.marker[m].folded >= 0) return;
    const double* field[3] = {q.u, q.v, q.w};
    for (int component = 0; component < 3; ++component) {
        const double* first = field[component] + set.marker[m].first[component];
        for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 3; ++b) __builtin_prefetch(first + c * g.plane() + b * g.row());
    }
}

// Known at compile time which direction is on faces: the 27 terms unroll.
template <int component>
inline double interpolate_inside(std::size_t row, std::size_t plane, const double* q,
                                 const MarkerStencils& s) {
    const double *x = s.weight[component == 0][0], *y = s.weight[component == 1][1],
                 *z = s.weight[component == 2][2];
    const double* p = q + s.first[component];
    const auto at = [](const double* r) { return *reinterpret_cast<const Four*>(r); };
    Four sum{};
    for (int c = 0; c < 3; ++c, p += plane)
        sum += z[c] * (y[0] * at(p) + y[1] * at(p + row) + y[2] * at(p + 2 * row));
    return x[0] * sum[0] + x[1] * sum[1] + x[2] * sum[2];
}

// Velocity at the markers, (markers, 3).
inline void interpolate(const Grid& g, const VelocityArrays& q, const StencilSet& set, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    const std::size_t row = g.row(), plane = g.plane();
#pragma omp parallel for num_threads(g.threads) schedule(static) if (set.count() > 256)
    for (int m = 0; m < set.count(); ++m) {
        const MarkerStencils& s = set.marker[m];
        prefetch(g, q, set, m + prefetch_ahead);
        if (s.folded < 0) {
            out[3 * m] = interpolate_inside<0>(row, plane, q.u, s);
            out[3 * m + 1] = interpolate_inside<1>(row, plane, q.v, s);
            out[3 * m + 2] = interpolate_inside<2>(row, plane, q.w, s);
        } else {
            for (int c = 0; c < 3; ++c)
                out[3 * m + c] = interpolate_folded(g, field[c], set.folded[s.folded], c);
        }
    }
}

// One marker's share in the planes [first, last).
inline void spread_folded(const Grid& g, double* q, const FoldedStencils& s, int component, double strength,
                          int first, int last) {
    const Stencil &x = s.along(0, component), &y = s.along(1, component), &z = s.along(2, component);
    for (int c = 0; c < 3; ++c) {
        if (z.index[c] < first || z.index[c] >= last) continue;
        for (int b = 0; b < 3; ++b) {
            double* r = q + z.index[c] * g.plane() + y.index[b] * g.row();
            const double f = strength * z.weight[c] * y.weight[b];
            for (int a = 0; a < 3; ++a) r[x.index[a]] += f * x.weight[a];
        }
    }
}

template <int component>
inline void spread_inside(std::size_t row, std::size_t plane, double* q, const MarkerStencils& s,
                          double strength, int first, int last) {
    const double *y = s.weight[component == 1][1], *z = s.weight[component == 2][2];
    const Four x = strength * three(s.weight[component == 0][0]);
    double* p = q + s.first[component];
    const int lowest = component == face_z ? s.face : s.plane - 1;
    const auto at = [](double* r) -> Four& { return *reinterpret_cast<Four*>(r); };
    for (int c = 0; c < 3; ++c, p += plane) {
        if (lowest + c < first || lowest + c >= last) continue;
        const Four f = z[c] * x;
        at(p) += y[0] * f;
        at(p + row) += y[1] * f;
        at(p + 2 * row) += y[2] * f;
    }
}

// q += factor * sum over markers of value * volume * delta: the adjoint of interpolate.
inline void spread(const Grid& g, const VelocityArrays& q, const StencilSet& set, const double* value,
                   const double* volume, double factor) {
    double* field[3] = {q.u, q.v, q.w};
    const double per_cell = factor / g.volume();
    const std::size_t row = g.row(), plane = g.plane();
    const int markers = set.count(), nz = g.nz();
    const int threads = markers > 256 ? std::min(g.threads, nz) : 1;
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        // Equal numbers of markers, cut between planes.
        const auto cut = [&](int t) {
            if (t == 0) return 1;
            if (t == team) return nz + 1;
            const auto share = static_cast<std::int32_t>(static_cast<long>(markers) * t / team);
            return static_cast<int>(std::upper_bound(set.below.begin(), set.below.end(), share) -
                                    set.below.begin() - 1);
        };
        const int first = cut(me), last = cut(me + 1);
        for (int b = 0; b + 1 < static_cast<int>(set.first.size()); ++b) {
            if (set.highest[b] < first || set.lowest[b] >= last) continue;
            for (int m = set.first[b]; m < set.first[b + 1]; ++m) {
                const MarkerStencils& s = set.marker[m];
                prefetch(g, q, set, m + prefetch_ahead);
                const double strength = per_cell * volume[m];
                const double* f = value + 3 * m;
                if (s.folded < 0) {
                    spread_inside<0>(row, plane, q.u, s, strength * f[0], first, last);
                    spread_inside<1>(row, plane, q.v, s, strength * f[1], first, last);
                    spread_inside<2>(row, plane, q.w, s, strength * f[2], first, last);
                } else {
                    for (int c = 0; c < 3; ++c)
                        spread_folded(g, field[c], set.folded[s.folded], c, strength * f[c], first, last);
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

// Of each body, its markers' volume V and moments about the centre: V, sum of V r (3), sum of V r r
// (xx, yy, zz, xy, yz, zx). (bodies, 10).
inline void marker_moments(int bodies, const std::int32_t* first, const double* arm, const double* volume,
                           int threads, double* out) {
#pragma omp parallel for num_threads(threads) schedule(static) if (bodies > 8)
    for (int b = 0; b < bodies; ++b) {
        double s[10] = {};
        for (int m = first[b]; m < first[b + 1]; ++m) {
            const double *r = arm + 3 * m, v = volume[m];
            s[0] += v;
            for (int c = 0; c < 3; ++c) {
                s[1 + c] += v * r[c];
                s[4 + c] += v * r[c] * r[c];
                s[7 + c] += v * r[c] * r[(c + 1) % 3];
            }
        }
        std::copy_n(s, 10, out + 10 * b);
    }
}

}  // namespace rdpm
