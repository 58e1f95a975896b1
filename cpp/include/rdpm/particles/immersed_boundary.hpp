// Markers and grid: interpolation and spreading, exact adjoints, and the sums over each body's markers.
//
// Markers are ordered by the plane and the row they lie in, whatever body they belong to: the fields then
// stream through the cache, which matters more than arithmetic where bodies are many. A marker away from the
// sides is kept as the place of its nearest centre and its distance from it, and its weights are found again
// at each use: that is less than reading them; across a periodic side its points are wrapped. Beside the
// other sides the stencils are folded, and kept. In spreading every thread adds only to the planes it owns,
// so no two threads touch a value and the order of a sum is fixed.
#pragma once
#include <omp.h>

#include <algorithm>
#include <cmath>
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
    std::int32_t marker;
    const Stencil& along(int d, int component) const { return d == component ? face_of[d] : centre_of[d]; }
};

struct InnerMarker {
    double from_centre[3];  // [cells], -0.5 to 0.5
    std::int32_t first;     // offset of the first of the 27 centres; its complement where points are wrapped
    std::int32_t marker;
    bool is_wrapped() const { return first < 0; }
};

struct StencilSet {
    std::vector<InnerMarker> inner;  // by plane, by row
    std::vector<FoldedStencils> folded;
    std::vector<std::int32_t> first;  // markers first[b] to first[b + 1] belong to body b
    std::vector<std::int32_t> row;    // of each marker, counted through all planes; -1 if folded
    std::vector<std::int32_t> begin;  // of each such row in `inner`, and one more

    StencilSet(const Grid& g, const std::int32_t* of_body, int bodies)
        : first(of_body, of_body + bodies + 1), row(first.back()), begin(rows(g) + 2) {
        inner.reserve(row.size());
    }
    static std::size_t rows(const Grid& g) { return static_cast<std::size_t>(g.nz() + 2) * (g.ny() + 2); }
    int count() const { return static_cast<int>(row.size()); }
    int count_inner() const { return static_cast<int>(inner.size()); }
    // The first marker of plane k in `inner`.
    int begin_of(const Grid& g, int k) const { return begin[static_cast<std::size_t>(k) * (g.ny() + 2)]; }
};

// Four neighbouring doubles at once; the fourth enters with weight zero.
typedef double Four __attribute__((vector_size(32), aligned(8), may_alias));

// Weights of a few inner markers at a time: [direction][marker], at centres and, three further on, on faces.
struct Weights {
    static constexpr int most = 16;
    double low[6 * most], middle[6 * most], high[6 * most];

    void find(const InnerMarker* marker, int count) {
        double r[6 * most] = {};
        for (int n = 0; n < count; ++n)
            for (int d = 0; d < 3; ++d) {
                const double x = marker[n].from_centre[d];
                r[d * most + n] = x;
                r[(3 + d) * most + n] = x - std::copysign(0.5, x);
            }
#pragma omp simd
        for (int n = 0; n < 6 * most; ++n) {
            const double x = r[n], m = (1.0 + std::sqrt(1.0 - 3.0 * x * x)) * (1.0 / 3.0);
            middle[n] = m;
            low[n] = 0.5 * (1.0 - m - x);
            high[n] = 0.5 * (1.0 - m + x);
        }
    }
};

// Along one direction, of the component whose faces lie across `component`.
template <int component>
constexpr int weights_along(int direction) {
    return Weights::most * (direction == component ? 3 + direction : direction);
}

// The first of a marker's 27 points of a component: below the nearest centre the nearest face is one before.
template <int component>
inline std::ptrdiff_t first_point(const InnerMarker& m, std::size_t row, std::size_t plane) {
    const std::size_t stride = component == 0 ? 1 : component == 1 ? row : plane;
    return m.first - static_cast<std::ptrdiff_t>(
                         stride & -static_cast<std::size_t>(std::signbit(m.from_centre[component])));
}

enum class Place { inside, wrapped, folded };

// The nearest centre, wrapped into the box, and the marker's distance from it in cells.
inline Place locate(const Grid& g, const double* x, int* middle, double* from_centre) {
    Place place = Place::inside;
    for (int d = 0; d < 3; ++d) {
        const double at = x[d] / g.spacing[d];
        const int nearest = static_cast<int>(std::floor(at + 1.0)), n = g.cells[d];
        from_centre[d] = at + 0.5 - nearest;
        middle[d] = nearest;
        // The nearest face may be one before; one point further on is read, with weight zero.
        if (nearest >= 3 && nearest < n - 1) continue;
        if (g.boundary[d] != periodic) return Place::folded;
        place = Place::wrapped;
        middle[d] = ((nearest - 1) % n + n) % n + 1;
    }
    return place;
}

inline void fold(const Grid& g, const double* x, FoldedStencils& out) {
    for (int d = 0; d < 3; ++d) {
        out.centre_of[d] = stencil_along(g, d, x[d], d == 0 ? face_y : face_x);
        out.face_of[d] = stencil_along(g, d, x[d], d);
    }
}

// Order and stencils of all markers.
inline void place(const Grid& g, const double* position, StencilSet& set) {
    const int markers = set.count();
    const auto row = static_cast<std::int32_t>(g.row()), plane = static_cast<std::int32_t>(g.plane());
#pragma omp parallel for num_threads(g.threads) schedule(static) if (markers > 256)
    for (int m = 0; m < markers; ++m) {
        int middle[3] = {};
        double from_centre[3];
        const bool folded = locate(g, position + 3 * m, middle, from_centre) == Place::folded;
        set.row[m] = folded ? -1 : middle[2] * (g.ny() + 2) + middle[1];
    }

    // begin[r + 1] counts, then moves from the begin of row r to its end while the markers are put in.
    std::fill(set.begin.begin(), set.begin.end(), 0);
    std::size_t folded = 0;
    for (int m = 0; m < markers; ++m) ++(set.row[m] < 0 ? set.begin[0] : set.begin[set.row[m] + 2]);
    folded = set.begin[0];
    set.begin[0] = 0;
    for (std::size_t r = 2; r < set.begin.size(); ++r) set.begin[r] += set.begin[r - 1];
    set.inner.resize(markers - folded);
    set.folded.resize(folded);
    folded = 0;
    for (int m = 0; m < markers; ++m)
        if (set.row[m] < 0)
            set.folded[folded++].marker = m;
        else
            set.inner[set.begin[set.row[m] + 1]++].marker = m;

#pragma omp parallel num_threads(g.threads) if (markers > 256)
    {
#pragma omp for schedule(static) nowait
        for (std::size_t n = 0; n < set.inner.size(); ++n) {
            InnerMarker& s = set.inner[n];
            int middle[3] = {};
            const Place place = locate(g, position + 3 * s.marker, middle, s.from_centre);
            s.first = (middle[2] - 1) * plane + (middle[1] - 1) * row + middle[0] - 1;
            if (place == Place::wrapped) s.first = ~s.first;
        }
#pragma omp for schedule(static)
        for (std::size_t n = 0; n < set.folded.size(); ++n)
            fold(g, position + 3 * set.folded[n].marker, set.folded[n]);
    }
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

// The nine rows of 27 points of a component about a marker beside a periodic side.
struct WrappedPoints {
    std::ptrdiff_t row[3][3];  // offset of its first cell; [plane][row]
    int plane[3], x[3];
    bool is_whole;  // three neighbours in memory

    // `nearest`: the nearest centre.
    WrappedPoints(const Grid& g, const InnerMarker& m, const int* nearest, int component) {
        int y[3];
        int* index[3] = {x, y, plane};
        for (int d = 0; d < 3; ++d) {
            const int n = g.cells[d],
                      low = nearest[d] - 1 - (d == component && std::signbit(m.from_centre[d]));
            for (int a = 0; a < 3; ++a)
                index[d][a] = low + a < 1 ? low + a + n : low + a > n ? low + a - n : low + a;
        }
        for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 3; ++b)
                row[c][b] = static_cast<std::ptrdiff_t>(plane[c] * g.plane() + y[b] * g.row());
        is_whole = x[2] == x[0] + 2;
    }
};

struct PointWeights {
    double x[3], y[3], z[3];

    PointWeights(const Weights& all, int component, int n) {
        double* out[3] = {x, y, z};
        for (int d = 0; d < 3; ++d) {
            const int at = Weights::most * (d == component ? 3 + d : d) + n;
            out[d][0] = all.low[at];
            out[d][1] = all.middle[at];
            out[d][2] = all.high[at];
        }
    }
};

inline void nearest_centre(const Grid& g, const InnerMarker& m, int* nearest) {
    const int first = ~m.first, row = static_cast<int>(g.row()), plane = static_cast<int>(g.plane());
    const int k = first / plane, j = (first - k * plane) / row;
    nearest[0] = first - k * plane - j * row + 1;
    nearest[1] = j + 1;
    nearest[2] = k + 1;
}

inline void interpolate_wrapped(const Grid& g, const VelocityArrays& q, const InnerMarker& m,
                                const Weights& weights, int n, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    int nearest[3];
    nearest_centre(g, m, nearest);
    for (int component = 0; component < 3; ++component) {
        const WrappedPoints at(g, m, nearest, component);
        const PointWeights w(weights, component, n);
        Four sum{};
        for (int c = 0; c < 3; ++c)
            for (int b = 0; b < 3; ++b) {
                const double* r = field[component] + at.row[c][b];
                sum += w.z[c] * w.y[b] *
                       (at.is_whole ? *reinterpret_cast<const Four*>(r + at.x[0])
                                    : Four{r[at.x[0]], r[at.x[1]], r[at.x[2]], 0.0});
            }
        out[component] = w.x[0] * sum[0] + w.x[1] * sum[1] + w.x[2] * sum[2];
    }
}

// What a marker soon to come will read first: the planes below it are in cache already. Both ends of a row's
// points, for these may lie in two lines. Inlined always: a call that only prefetches is removed as one
// without effect.
constexpr int prefetch_ahead = 16;

[[gnu::always_inline]] inline void prefetch(const VelocityArrays& q, std::size_t row, std::size_t plane,
                                            const InnerMarker& m) {
    if (m.is_wrapped()) return;
    for (const double* field : {q.u, q.v, q.w}) {
        const double* p = field + m.first + 2 * plane;
        for (int b = 0; b < 3; ++b, p += row) {
            __builtin_prefetch(p - 1);
            __builtin_prefetch(p + 3);
        }
    }
}

// Known at compile time which direction is on faces: the 27 terms unroll.
template <int component>
inline double interpolate_inner(std::size_t row, std::size_t plane, const double* q, const InnerMarker& m,
                                const Weights& weights, int n) {
    constexpr int x = weights_along<component>(0), y = weights_along<component>(1),
                  z = weights_along<component>(2);
    const double* p = q + first_point<component>(m, row, plane);
    const double y_low = weights.low[y + n], y_middle = weights.middle[y + n], y_high = weights.high[y + n];
    const auto in_plane = [&](const double* r) {
        const auto at = [](const double* value) { return *reinterpret_cast<const Four*>(value); };
        return y_low * at(r) + y_middle * at(r + row) + y_high * at(r + 2 * row);
    };
    const Four sum = weights.low[z + n] * in_plane(p) + weights.middle[z + n] * in_plane(p + plane) +
                     weights.high[z + n] * in_plane(p + 2 * plane);
    return weights.low[x + n] * sum[0] + weights.middle[x + n] * sum[1] + weights.high[x + n] * sum[2];
}

// Velocity at the markers, (markers, 3).
inline void interpolate(const Grid& g, const VelocityArrays& q, const StencilSet& set, double* out) {
    const double* field[3] = {q.u, q.v, q.w};
    const std::size_t row = g.row(), plane = g.plane();
    const int inner = set.count_inner(), folded = static_cast<int>(set.folded.size());
#pragma omp parallel num_threads(g.threads) if (set.count() > 256)
    {
#pragma omp for schedule(static) nowait
        for (int begin = 0; begin < inner; begin += Weights::most) {
            const InnerMarker* marker = set.inner.data() + begin;
            const int count = std::min(Weights::most, inner - begin);
            Weights weights;
            weights.find(marker, count);
            for (int n = 0; n < count; ++n) {
                prefetch(q, row, plane, set.inner[std::min(begin + n + prefetch_ahead, inner - 1)]);
                double* value = out + 3 * marker[n].marker;
                if (marker[n].is_wrapped()) {
                    interpolate_wrapped(g, q, marker[n], weights, n, value);
                    continue;
                }
                value[0] = interpolate_inner<0>(row, plane, q.u, marker[n], weights, n);
                value[1] = interpolate_inner<1>(row, plane, q.v, marker[n], weights, n);
                value[2] = interpolate_inner<2>(row, plane, q.w, marker[n], weights, n);
            }
        }
#pragma omp for schedule(static)
        for (int n = 0; n < folded; ++n)
            for (int c = 0; c < 3; ++c)
                out[3 * set.folded[n].marker + c] = interpolate_folded(g, field[c], set.folded[n], c);
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

// `lowest`: plane of the first of the marker's centres.
template <int component, bool bounded>
inline void spread_inner(std::size_t row, std::size_t plane, double* q, const InnerMarker& m,
                         const Weights& weights, int n, double strength, int lowest, int first, int last) {
    constexpr int x = weights_along<component>(0), y = weights_along<component>(1),
                  z = weights_along<component>(2);
    const Four along_x = strength * Four{weights.low[x + n], weights.middle[x + n], weights.high[x + n], 0.0};
    double* p = q + first_point<component>(m, row, plane);
    if (component == face_z) lowest -= std::signbit(m.from_centre[2]);
    const double in_z[3] = {weights.low[z + n], weights.middle[z + n], weights.high[z + n]};
    const double y_low = weights.low[y + n], y_middle = weights.middle[y + n], y_high = weights.high[y + n];
    const auto at = [](double* r) -> Four& { return *reinterpret_cast<Four*>(r); };
    for (int c = 0; c < 3; ++c, p += plane) {
        if (bounded && (lowest + c < first || lowest + c >= last)) continue;
        const Four f = in_z[c] * along_x;
        at(p) += y_low * f;
        at(p + row) += y_middle * f;
        at(p + 2 * row) += y_high * f;
    }
}

// What a marker gives to the planes [first, last).
inline void spread_wrapped(const Grid& g, const VelocityArrays& q, const InnerMarker& m,
                           const Weights& weights, int n, const double* value, double strength, int first,
                           int last) {
    double* field[3] = {q.u, q.v, q.w};
    int nearest[3];
    nearest_centre(g, m, nearest);
    for (int component = 0; component < 3; ++component) {
        const WrappedPoints at(g, m, nearest, component);
        const PointWeights w(weights, component, n);
        const Four along_x = strength * value[component] * Four{w.x[0], w.x[1], w.x[2], 0.0};
        for (int c = 0; c < 3; ++c) {
            if (at.plane[c] < first || at.plane[c] >= last) continue;
            for (int b = 0; b < 3; ++b) {
                double* r = field[component] + at.row[c][b];
                const Four f = w.z[c] * w.y[b] * along_x;
                if (at.is_whole)
                    *reinterpret_cast<Four*>(r + at.x[0]) += f;
                else
                    for (int a = 0; a < 3; ++a) r[at.x[a]] += f[a];
            }
        }
    }
}

struct Source {
    const double *value, *volume;  // (markers, 3), (markers)
    double factor;

    [[gnu::always_inline]] void prefetch(int marker) const {
        __builtin_prefetch(value + 3 * marker);
        __builtin_prefetch(value + 3 * marker + 2);
        __builtin_prefetch(volume + marker);
    }
};

// What the inner markers whose nearest centre is in plane k give to the planes [first, last).
template <bool bounded>
inline void spread_from_plane(const Grid& g, const VelocityArrays& q, const StencilSet& set,
                              const Source& source, int k, int first, int last) {
    const std::size_t row = g.row(), plane = g.plane();
    for (int begin = set.begin_of(g, k), end = set.begin_of(g, k + 1); begin < end; begin += Weights::most) {
        const InnerMarker* marker = set.inner.data() + begin;
        const int count = std::min(Weights::most, end - begin);
        Weights weights;
        weights.find(marker, count);
        for (int n = 0; n < count; ++n) {
            const InnerMarker& m = marker[n];
            const InnerMarker& later = set.inner[std::min(begin + n + prefetch_ahead, set.count_inner() - 1)];
            prefetch(q, row, plane, later);
            source.prefetch(later.marker);
            const double *f = source.value + 3 * m.marker, strength = source.factor * source.volume[m.marker];
            if (m.is_wrapped()) {
                spread_wrapped(g, q, m, weights, n, f, strength, first, last);
                continue;
            }
            spread_inner<0, bounded>(row, plane, q.u, m, weights, n, strength * f[0], k - 1, first, last);
            spread_inner<1, bounded>(row, plane, q.v, m, weights, n, strength * f[1], k - 1, first, last);
            spread_inner<2, bounded>(row, plane, q.w, m, weights, n, strength * f[2], k - 1, first, last);
        }
    }
}

// q += factor * sum over markers of value * volume * delta: the adjoint of interpolate.
inline void spread(const Grid& g, const VelocityArrays& q, const StencilSet& set, const double* value,
                   const double* volume, double factor) {
    double* field[3] = {q.u, q.v, q.w};
    const Source source{value, volume, factor / g.volume()};
    const int nz = g.nz();
    const long inner = set.count_inner();
    const int threads = set.count() > 256 ? std::min(g.threads, nz) : 1;
#pragma omp parallel num_threads(threads)
    {
        const int team = omp_get_num_threads(), me = omp_get_thread_num();
        // Equal numbers of markers, cut between planes.
        const auto cut = [&](int t) {
            if (t == team) return nz + 1;
            int k = 1;
            while (k <= nz && set.begin_of(g, k) < inner * t / team) ++k;
            return t == 0 ? 1 : k;
        };
        const int first = cut(me), last = cut(me + 1);
        // Plane k gives to planes k - 2 to k + 1, beyond a periodic side to those at the other.
        const auto reaches = [&](int k) {
            for (int at = k - 2; at <= k + 1; ++at) {
                const int wrapped = at < 1 ? at + nz : at > nz ? at - nz : at;
                if (wrapped >= first && wrapped < last) return true;
            }
            return false;
        };
        for (int k = 1; k <= nz; ++k) {
            if (!reaches(k)) continue;
            if (k - 2 >= first && k + 1 < last)
                spread_from_plane<false>(g, q, set, source, k, first, last);
            else
                spread_from_plane<true>(g, q, set, source, k, first, last);
        }
        for (const FoldedStencils& s : set.folded) {
            const double strength = source.factor * volume[s.marker];
            for (int c = 0; c < 3; ++c)
                spread_folded(g, field[c], s, c, strength * value[3 * s.marker + c], first, last);
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
